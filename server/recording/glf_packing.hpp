// SPDX-License-Identifier: Apache-2.0
// Makes a .glf from a .dat, one slice at a time (protocol/glf/README.md 1.1 and "Recording").
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/glf/deflate.hpp"
#include "protocol/glf/packer.hpp"
#include "server/recording/append_file.hpp"
#include "server/recording/recording_config.hpp"

namespace sonard::server {

/// Packs a .dat that is no longer written, finished or not. It cuts off bytes after the last whole record and
/// appends the terminator. The .glf gets its final name only when it is on the disk; then the .dat is
/// removed. So a power cut, or kill -9, at any moment leaves one of the two.
///
/// If the .glf cannot be written, an error is logged and the .dat stays: it is a log too, and is packed at
/// the next start of the daemon.
class GlfPacking {
 public:
  /// Does nothing until the first step().
  GlfPacking(std::filesystem::path dat, RecordingSync sync) : dat_path_(std::move(dat)), sync_(sync) {}

  /// Packs one more slice: copies at most slice_bytes and, except for RecordingSync::never, waits until they
  /// are on the disk. @return false if it is done or given up
  bool step();

  static constexpr std::uint64_t slice_bytes = 16 * glf::pack_block_size;

 private:
  // Each returns false if it is done or given up.
  bool begin();
  bool close_dat();
  bool copy_slice();
  bool finish();
  bool good(const std::error_code& error);
  bool give_up(const std::string& why);
  glf::Packer packer() const;

  std::filesystem::path dat_path_;
  RecordingSync sync_;
  bool begun_ = false;
  std::string stem_;
  std::string config_xml_;
  glf::CivilTime closed_;
  std::uint64_t dat_size_ = 0;
  std::uint64_t copied_ = 0;
  glf::Crc32 crc_;
  std::ifstream dat_;
  AppendFile glf_;
  std::vector<std::uint8_t> slice_;
};

}  // namespace sonard::server
