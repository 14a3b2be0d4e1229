// SPDX-License-Identifier: Apache-2.0
// Events, folders and limits for the tests of recordings.
#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "server/recording/events.hpp"
#include "server/recording/log.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::test {

/// No file of this process may be longer than this while it lives: a full disk that needs no rights.
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

/// Sample of a ping at (line, beam): hard to compress, and different for every ping.
std::uint8_t sample(std::uint64_t ping_number, int line, int beam);

/// A ping of so many lines of 256 beams with these samples.
PingRecord ping_record(std::uint64_t number, int lines, server::TimePoint time);
server::RecordingEvent ping_event(std::uint64_t number, int lines, server::TimePoint time);
/// One datagram of so many bytes to a client at 127.0.0.1:52900.
server::RecordingEvent wire_event(std::size_t bytes, server::TimePoint time);

/// "bow", the one head, 601, with a .glf.
std::vector<server::HeadToRecord> one_head();

}  // namespace sonard::test
