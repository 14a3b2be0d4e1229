// SPDX-License-Identifier: Apache-2.0
// A summary of a log as text for people and as JSON.
#pragma once

#include <cstdint>
#include <string>

#include "server/logs/log_summary.hpp"

namespace sonard::server {

/// Several lines, each ending in a line break.
/// @param utc_offset_s of the zone of a .glf's times, which the log does not contain
std::string info_text(const LogSummary& log, std::int32_t utc_offset_s);

/// One JSON object (docs/logs.md, "What is in a log"); numbers in SI units, times as ISO 8601.
std::string info_json(const LogSummary& log, std::int32_t utc_offset_s);

/// "2026-11-20T14:22:33.120Z" for UTC, "2026-11-20T14:22:33.120" for times of an unknown zone.
std::string iso_time(std::int64_t time_ns, bool utc);

/// Offset from UTC of this machine's zone at a local time, in seconds.
std::int32_t local_utc_offset_s(std::int64_t local_time_ns);

}  // namespace sonard::server
