// SPDX-License-Identifier: Apache-2.0
// A file that only grows and stays whole if the disk is full.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

namespace sonard::server {

/// Belongs to the recorder's thread, like all file access in this folder.
class AppendFile {
 public:
  AppendFile() = default;
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;

  /// Creates a file that must not exist. On failure the result is not open and `error` has the reason.
  static AppendFile create(const std::filesystem::path& path, std::error_code& error);
  static AppendFile open(const std::filesystem::path& path, std::error_code& error);

  bool is_open() const { return fd_ >= 0; }
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Writes all of `bytes` or nothing: on failure the file is truncated to its former size, so that it ends
  /// with the last piece written whole. Requires an open file.
  std::error_code append(std::span<const std::uint8_t> bytes);
  /// Overwrites existing bytes. Requires an open file.
  std::error_code overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  std::error_code truncate(std::uint64_t size);
  /// Blocks until the file is on the disk.
  std::error_code sync();
  void close();

 private:
  int fd_ = -1;
  std::filesystem::path path_;
  std::uint64_t size_ = 0;
};

/// Makes a created, renamed or removed name survive a power cut.
void sync_directory(const std::filesystem::path& directory);

}  // namespace sonard::server
