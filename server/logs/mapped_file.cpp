// SPDX-License-Identifier: Apache-2.0
#include "server/logs/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

namespace sonard::server {
namespace {

std::error_code last_file_error() {
  return {errno, std::generic_category()};
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path) {
  // O_NONBLOCK: opening a pipe must not wait for its writer.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) {
    error_ = last_file_error();
    return;
  }
  struct stat status {};
  if (fstat(fd, &status) != 0) {
    error_ = last_file_error();
  } else if (!S_ISREG(status.st_mode)) {
    error_ = std::make_error_code(std::errc::invalid_argument);
  } else if (const auto size = static_cast<std::size_t>(status.st_size); size > 0) {
    void* const start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, fd, 0);
    if (start == MAP_FAILED) {
      error_ = last_file_error();
    } else {
      bytes_ = {static_cast<const std::uint8_t*>(start), size};
    }
  }
  ::close(fd);
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) {
    munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
  }
}

}  // namespace sonard::server
