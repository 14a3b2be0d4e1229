// SPDX-License-Identifier: Apache-2.0
// One file of a recording, with what is done when it cannot be written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

#include "server/config/config.hpp"
#include "server/recording/append_file.hpp"

namespace sonard::server {

/// A file that fails is given up: that is logged, once, and what else is written to it goes nowhere. It ends
/// with the last piece that was written whole. Serving does not depend on it.
class GrowingLog {
 public:
  explicit GrowingLog(RecordingSync sync) : sync_(sync) {}

  bool begun() const { return begun_; }
  bool failed() const { return failed_; }
  std::uint64_t size() const { return file_.size(); }
  const std::filesystem::path& path() const { return file_.path(); }

  /// Makes the file. Call it once.
  void begin(const std::filesystem::path& path);
  /// A piece after which the file is whole, or can be made so. Goes nowhere before begin().
  void append(std::span<const std::uint8_t> piece);
  /// In place of bytes that were appended.
  void overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  /// Cuts it off behind bytes that were appended.
  void truncate(std::uint64_t size);
  void sync();
  /// Nothing is written after that.
  void end();

 private:
  void fail(const std::error_code& error);

  RecordingSync sync_;
  AppendFile file_;
  bool begun_ = false;
  bool failed_ = false;
};

}  // namespace sonard::server
