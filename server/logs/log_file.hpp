// SPDX-License-Identifier: Apache-2.0
// A log file, mapped into memory, and its format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include "server/error/error.hpp"
#include "server/logs/mapped_file.hpp"

namespace sonard::server {

enum class LogKind {
  glf,     ///< packed (protocol/glf/README.md)
  dat,     ///< the records of a .glf without its archive
  mcap,    ///< sonard's own
  pcapng,  ///< packets
  sonar,   ///< images of one head, packet after packet (protocol/sonar3d15/README.md 9)
};

/// ".glf", ".dat", ".mcap", ".pcapng", ".sonar".
std::string_view name_of(LogKind kind);

/// Read-only. The bytes stay in place while the object lives (MappedFile).
class LogFile {
 public:
  /// Detects the kind by the first bytes, whatever the file's name. If they are unknown, by its name, because
  /// a log may be damaged there.
  /// @throws Error if the file cannot be read or is of no known kind
  explicit LogFile(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  std::span<const std::uint8_t> bytes() const { return file_.bytes(); }
  LogKind kind() const { return kind_; }

  /// A log that cannot be used: "PATH: what".
  Error error(std::string_view what) const;

 private:
  LogKind find_kind() const;

  std::filesystem::path path_;
  MappedFile file_;
  LogKind kind_;
};

}  // namespace sonard::server
