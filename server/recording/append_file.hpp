// SPDX-License-Identifier: Apache-2.0
// A file that only grows, and that a full disk leaves whole.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <system_error>

namespace sonard::server {

/// The recorder's thread only, like everything here that touches a file.
class AppendFile {
 public:
  AppendFile() = default;
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;

  /// Makes a file that was not there. On failure the result is not open and `error` says why.
  static AppendFile create(const std::filesystem::path& path, std::error_code& error);
  /// Opens a file to go on behind what is in it.
  static AppendFile open(const std::filesystem::path& path, std::error_code& error);

  bool is_open() const { return fd_ >= 0; }
  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const { return size_; }

  /// Writes all of `bytes` or, where that fails, none: the file is cut back to what it was, so that it ends
  /// with the last piece that was written whole. Requires an open file.
  std::error_code append(std::span<const std::uint8_t> bytes);
  /// Overwrites bytes that are there. Requires an open file.
  std::error_code overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes);
  std::error_code truncate(std::uint64_t size);
  /// Waits until all of it is on the disk.
  std::error_code sync();
  void close();

 private:
  int fd_ = -1;
  std::filesystem::path path_;
  std::uint64_t size_ = 0;
};

/// So that a name that was made, changed or removed survives a power cut.
void sync_directory(const std::filesystem::path& directory);

}  // namespace sonard::server
