// SPDX-License-Identifier: Apache-2.0
// A file of the lines of a scan.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "protocol/micron/client.hpp"

namespace sonard::client {

/// Writes JSON Lines, one object for each line of the scan (docs/sonarview.md). Such a file can be read while
/// it grows and after a crash. A line of a scan has both named numbers and samples, which do not fit a table.
class LineFile {
 public:
  /// Creates an empty file, and replaces an existing one.
  /// @throws std::runtime_error that names the file
  explicit LineFile(std::filesystem::path path);

  /// @param sweep counts from 0. On return the operating system has the line.
  void write(const micron::ReceivedLine& line, std::uint64_t sweep);
  /// Whether a write failed.
  bool failed() const { return !out_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace sonard::client
