// SPDX-License-Identifier: Apache-2.0
// A log on disk, mapped into memory, and its format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string_view>

namespace sonard::server {

/// A log that cannot be used. what() is one line that names the file.
struct LogError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class LogKind {
  glf,     ///< packed (docs/logs.md 1)
  dat,     ///< the records of a .glf without its archive
  mcap,    ///< sonard's own
  pcapng,  ///< packets
};

/// ".glf", ".dat", ".mcap", ".pcapng".
std::string_view name_of(LogKind kind);

/// Read-only; the bytes stay where they are as long as the object lives. A file that is cut meanwhile
/// ends the program, as every mapped file does: logs that are still being written only grow.
class LogFile {
 public:
  /// Tells kinds apart by the first bytes, whatever the file is called. Unknown first bytes: by its name.
  /// @throws LogError when it cannot be read or is none of them
  explicit LogFile(std::filesystem::path path);
  ~LogFile();
  LogFile(const LogFile&) = delete;
  LogFile& operator=(const LogFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::span<const std::uint8_t> bytes() const { return bytes_; }
  LogKind kind() const { return kind_; }

  /// "PATH: what"
  LogError error(std::string_view what) const;

 private:
  LogKind find_kind() const;

  std::filesystem::path path_;
  std::span<const std::uint8_t> bytes_;
  LogKind kind_;
};

}  // namespace sonard::server
