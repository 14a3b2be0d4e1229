// SPDX-License-Identifier: Apache-2.0
#include "server/recording/append_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace sonard::server {
namespace {

std::error_code last_error() {
  return {errno, std::generic_category()};
}

constexpr int permissions = 0644;

}  // namespace

AppendFile::~AppendFile() {
  close();
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), path_(std::move(other.path_)), size_(other.size_) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  std::swap(fd_, other.fd_);
  std::swap(path_, other.path_);
  std::swap(size_, other.size_);
  return *this;
}

AppendFile AppendFile::create(const std::filesystem::path& path, std::error_code& error) {
  AppendFile file;
  file.path_ = path;
  file.fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, permissions);
  error = file.is_open() ? std::error_code() : last_error();
  return file;
}

AppendFile AppendFile::open(const std::filesystem::path& path, std::error_code& error) {
  AppendFile file;
  file.path_ = path;
  file.fd_ = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  struct stat status {};
  error = file.is_open() && fstat(file.fd_, &status) == 0 ? std::error_code() : last_error();
  file.size_ = static_cast<std::uint64_t>(status.st_size);
  return file;
}

std::error_code AppendFile::append(std::span<const std::uint8_t> bytes) {
  const std::uint64_t before = size_;
  if (const std::error_code error = overwrite(size_, bytes)) {
    truncate(before);
    return error;
  }
  size_ = before + bytes.size();
  return {};
}

std::error_code AppendFile::overwrite(std::uint64_t offset, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = pwrite(fd_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno != EINTR) {
      return last_error();
    }
    const std::size_t count = written > 0 ? static_cast<std::size_t>(written) : 0;
    bytes = bytes.subspan(count);
    offset += count;
  }
  return {};
}

std::error_code AppendFile::truncate(std::uint64_t size) {
  if (ftruncate(fd_, static_cast<off_t>(size)) != 0) {
    return last_error();
  }
  size_ = size;
  return {};
}

std::error_code AppendFile::sync() {
  return fdatasync(fd_) == 0 ? std::error_code() : last_error();
}

void AppendFile::close() {
  if (is_open()) {
    ::close(std::exchange(fd_, -1));
  }
}

void sync_directory(const std::filesystem::path& directory) {
  const int fd = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd >= 0) {
    fsync(fd);
    ::close(fd);
  }
}

}  // namespace sonard::server
