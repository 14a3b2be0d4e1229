// SPDX-License-Identifier: Apache-2.0
// One file of a recording, with error handling.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

#include "server/config/config.hpp"
#include "server/recording/append_file.hpp"

namespace sonard::server {

/// If a file fails, the error is logged once and later writes are discarded. The file ends with the last
/// piece written whole. Serving is not affected.
class GrowingLog {
 public:
  explicit GrowingLog(RecordingSync sync) : sync_(sync) {}

  bool begun() const { return begun_; }
  bool failed() const { return failed_; }
  std::uint64_t size() const { return file_.size(); }
  const std::filesystem::path& path() const { return file_.path(); }

  /// Creates the file. Call it once.
  void begin(const std::filesystem::path& path);
  /// Appends a piece after which the file is whole or recoverable. Discarded before begin().
  void append(std::span<const std::uint8_t> piece);
  /// Overwrites bytes that were appended.
  void overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Truncates the file after bytes that were appended.
  void truncate(std::uint64_t size);
  void sync();
  /// Closes the file; nothing is written after that.
  void end();

 private:
  void fail(const std::error_code& error);

  RecordingSync sync_;
  AppendFile file_;
  bool begun_ = false;
  bool failed_ = false;
};

}  // namespace sonard::server
