// SPDX-License-Identifier: Apache-2.0
// A file mapped into memory for reading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

namespace sonard::server {

/// The bytes stay in place while the object lives. If another process truncates the file, the next read ends
/// this program, as with every mapped file; logs only grow while they are written.
class MappedFile {
 public:
  /// Maps a regular file. On failure bytes() is empty and error() has the reason. An empty file is not an
  /// error.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::span<const std::uint8_t> bytes() const { return bytes_; }
  /// EACCES, ENOENT and so on; EINVAL if the path is not a regular file.
  const std::error_code& error() const { return error_; }

 private:
  std::span<const std::uint8_t> bytes_;
  std::error_code error_;
};

}  // namespace sonard::server
