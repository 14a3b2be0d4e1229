// SPDX-License-Identifier: Apache-2.0
// One file of a recording, with error handling.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

#include "server/recording/append_file.hpp"
#include "server/recording/recording_config.hpp"

namespace sonard::server {

/// If a file fails, the error is logged once and later writes are discarded. The file ends with the last
/// piece written whole. Serving is not affected.
class GrowingLog {
 public:
  explicit GrowingLog(RecordingSync sync) : sync_(sync) {}

  bool begun() const { return begun_; }
  bool failed() const { return failed_; }
  const std::error_code& error() const { return error_; }  ///< why it failed
  std::uint64_t size() const { return file_.size(); }
  const std::filesystem::path& path() const { return file_.path(); }

  /// Lines in the program's log: none for a file with a temporary name, whose owner logs its own.
  enum class Lines : std::uint8_t { all, none };
  /// Creates the file. Call it once.
  void begin(const std::filesystem::path& path, Lines lines = Lines::all);
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
  std::error_code error_;
  Lines lines_ = Lines::all;
};

}  // namespace sonard::server
