// SPDX-License-Identifier: Apache-2.0
#include "server/info/info.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "common/text/printable.hpp"
#include "server/devices/types/types.hpp"
#include "server/info/info_text.hpp"
#include "server/info/thumbnails.hpp"

namespace sonard::server {
namespace {

std::int32_t utc_offset_s(const LogSummary& log, const InfoOptions& options) {
  if (options.utc_offset_h) {
    return static_cast<std::int32_t>(std::lround(3600.0 * *options.utc_offset_h));
  }
  return log.span_ns ? local_utc_offset_s(log.span_ns->first) : 0;
}

}  // namespace

void info(const std::filesystem::path& path, const InfoOptions& options) {
  const LogFile file(path);
  const LogSummary log = summarise(file, &ping_in, &open_packet_log);
  const std::int32_t offset_s = utc_offset_s(log, options);
  fmt::print("{}", options.json ? info_json(log, offset_s) : info_text(log, offset_s));
  for (const std::string& problem : log.problems) {
    fmt::print(stderr, "warning: {}: {}\n", printable(path.string()), printable(problem));
  }
  if (options.pictures) {
    const std::uint64_t written =
        write_thumbnails(*open_log(file, &open_packet_log), file, *options.pictures, options.every);
    fmt::print(stderr, "{} pictures in {}\n", written, options.pictures->string());
  }
}

}  // namespace sonard::server
