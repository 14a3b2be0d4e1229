// SPDX-License-Identifier: Apache-2.0
// Events, folders and limits for the tests of recordings.
#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/recording/events.hpp"
#include "server/recording/glf_device.hpp"
#include "server/recording/log_writer.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::test {

/// Limits the length of this process's files while it lives. This emulates a full disk without root rights.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uint64_t bytes);
  ~FileSizeLimit();
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

std::vector<std::uint8_t> contents(const std::filesystem::path& path);
void write_file(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes);

/// Sample of a ping at (line, beam). The samples are hard to compress, and they differ between pings.
std::uint8_t sample(std::uint64_t ping_number, int line, int beam);

/// A ping of `lines` lines of 256 beams with these samples.
PingRecord ping_record(std::uint64_t number, int lines, server::TimePoint time);
server::RecordingEvent ping_event(std::uint64_t number, int lines, server::TimePoint time);
/// One datagram of `bytes` bytes to a client at 127.0.0.1:52900.
server::RecordingEvent wire_event(std::size_t bytes, server::TimePoint time);

/// A type of device with .glf logs that store no statuses.
const server::GlfDevice& glf_device_without_statuses();
/// A list with one head, "bow", ID 601, which has a .glf.
std::vector<server::HeadToRecord> one_head();

}  // namespace sonard::test
