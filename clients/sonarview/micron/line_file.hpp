// SPDX-License-Identifier: Apache-2.0
// Lines of a scan in a file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>

#include "protocol/micron/host.hpp"

namespace sonard::client {

/// JSON, an object for each line of the scan on a line of its own (docs/sonarview.md): it can be read while
/// it grows and after a crash, without knowing how many lines there will be, and by everything; and a line
/// of a scan has both named numbers and samples, which neither a table nor an array holds alone.
class LineFile {
 public:
  /// Begins an empty file.
  /// @throws std::runtime_error naming it
  explicit LineFile(std::filesystem::path path);

  /// `turn` counts turns from 0. The line is with the operating system on return.
  void write(const micron::ReceivedLine& line, std::uint64_t sweep);
  /// Whether something could not be written.
  bool failed() const { return !out_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace sonard::client
