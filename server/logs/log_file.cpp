// SPDX-License-Identifier: Apache-2.0
#include "server/logs/log_file.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace sonard::server {
namespace {

struct Start {
  std::array<std::uint8_t, 4> bytes;
  std::size_t count;
  LogKind kind;
};

// A .dat starts with a record, or with its terminator if it has no records.
constexpr std::array starts{
    Start{{'P', 'K', 3, 4}, 4, LogKind::glf},
    Start{{'*', 2, 0, 0}, 2, LogKind::dat},
    Start{{0xDE, 0xDE, 0, 0}, 2, LogKind::dat},
    Start{{0x89, 'M', 'C', 'A'}, 4, LogKind::mcap},
    Start{{0x0A, 0x0D, 0x0D, 0x0A}, 4, LogKind::pcapng},
    Start{{'R', 'I', 'P', 0}, 3, LogKind::sonar},
};

/// The extension before the suffix with which a recorder keeps a damaged log: ".damaged", ".damaged-2".
std::string extension_of(const std::filesystem::path& path) {
  const std::string last = path.extension();
  return last.starts_with(".damaged") ? path.stem().extension().string() : last;
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
      return ".pcapng";
    case LogKind::sonar:
      break;
  }
  return ".sonar";
}

LogFile::LogFile(std::filesystem::path path) : path_(std::move(path)), file_(path_) {
  if (file_.error() == std::errc::invalid_argument) {
    throw error("is not a file (expected a log)");
  }
  if (file_.error()) {
    throw error(fmt::format("cannot be opened: {}", file_.error().message()));
  }
  kind_ = find_kind();
}

Error LogFile::error(std::string_view what) const {
  return {ErrorKind::configuration, fmt::format("{}: {}", path_.string(), what)};
}

LogKind LogFile::find_kind() const {
  const auto differing = [&](const Start& start) {
    return std::inner_product(start.bytes.begin(), start.bytes.begin() + start.count, file_.bytes().begin(),
                              0, std::plus{}, std::not_equal_to{});
  };
  for (const Start& start : starts) {
    if (file_.bytes().size() >= start.count && differing(start) == 0) {
      return start.kind;
    }
  }
  const std::string extension = extension_of(path_);
  if (file_.bytes().empty() && extension == name_of(LogKind::dat)) {
    return LogKind::dat;  // nothing has been written yet
  }
  // The first bytes may be damaged. Readers of .mcap, .pcapng and .sonar search for the first readable
  // record.
  for (const Start& start : starts) {
    const bool searches =
        start.kind == LogKind::mcap || start.kind == LogKind::pcapng || start.kind == LogKind::sonar;
    if (extension == name_of(start.kind) && file_.bytes().size() >= start.count &&
        (searches || differing(start) == 1)) {
      return start.kind;
    }
  }
  throw error(file_.bytes().empty() ? "is empty"
                                    : "is not a log (expected a .glf, .dat, .mcap, .pcapng or .sonar)");
}

}  // namespace sonard::server
