// SPDX-License-Identifier: Apache-2.0
#include "server/logs/log_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace sonard::server {
namespace {

struct Start {
  std::array<std::uint8_t, 4> bytes;
  std::size_t count;
  LogKind kind;
};

// A .dat begins with a record, or where it has none with its terminator.
constexpr std::array starts{
    Start{{'P', 'K', 3, 4}, 4, LogKind::glf},
    Start{{'*', 2, 0, 0}, 2, LogKind::dat},
    Start{{0xDE, 0xDE, 0, 0}, 2, LogKind::dat},
    Start{{0x89, 'M', 'C', 'A'}, 4, LogKind::mcap},
    Start{{0x0A, 0x0D, 0x0D, 0x0A}, 4, LogKind::pcapng},
};

std::string reason() {
  return std::generic_category().message(errno);
}

std::span<const std::uint8_t> map(int file, std::size_t size) {
  if (size == 0) {
    return {};
  }
  void* const start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  return start == MAP_FAILED ? std::span<const std::uint8_t>{}
                             : std::span(static_cast<const std::uint8_t*>(start), size);
}

}  // namespace

std::string_view name_of(LogKind kind) {
  switch (kind) {
    case LogKind::glf:
      return ".glf";
    case LogKind::dat:
      return ".dat";
    case LogKind::mcap:
      return ".mcap";
    case LogKind::pcapng:
      break;
  }
  return ".pcapng";
}

LogFile::LogFile(std::filesystem::path path) : path_(std::move(path)) {
  const int file = open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    throw error(fmt::format("cannot be opened: {}", reason()));
  }
  struct stat status {};
  const bool regular = fstat(file, &status) == 0 && S_ISREG(status.st_mode);
  const std::size_t size = regular ? static_cast<std::size_t>(status.st_size) : 0;
  bytes_ = map(file, size);
  const std::string why = reason();
  close(file);
  if (!regular) {
    throw error("is no file (expected a log)");
  }
  if (bytes_.size() != size) {
    throw error(fmt::format("cannot be read: {}", why));
  }
  try {
    kind_ = find_kind();
  } catch (...) {
    munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
    throw;
  }
}

LogFile::~LogFile() {
  if (!bytes_.empty()) {
    munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
  }
}

LogError LogFile::error(std::string_view what) const {
  return LogError(fmt::format("{}: {}", path_.string(), what));
}

LogKind LogFile::find_kind() const {
  const auto differing = [&](const Start& start) {
    return std::inner_product(start.bytes.begin(), start.bytes.begin() + start.count, bytes_.begin(), 0,
                              std::plus{}, std::not_equal_to{});
  };
  for (const Start& start : starts) {
    if (bytes_.size() >= start.count && differing(start) == 0) {
      return start.kind;
    }
  }
  const std::string extension = path_.extension();
  if (bytes_.empty() && extension == name_of(LogKind::dat)) {
    return LogKind::dat;  // nothing has been written yet
  }
  // One of the first bytes may be damaged.
  for (const Start& start : starts) {
    if (extension == name_of(start.kind) && bytes_.size() >= start.count && differing(start) == 1) {
      return start.kind;
    }
  }
  throw error(bytes_.empty() ? "is empty" : "is no log (expected a .glf, .dat, .mcap or .pcapng)");
}

}  // namespace sonard::server
