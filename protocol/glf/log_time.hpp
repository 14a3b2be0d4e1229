// SPDX-License-Identifier: Apache-2.0
// The clock of logs, and file names made from it. Source: protocol/glf/README.md 1.1, 1.6.
// A log counts seconds since 1980-01-01 00:00:00 local time and does not contain the zone, so the zone's
// offset from UTC is an argument. Keep it constant from the opening of a log on, because local time jumps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sonard::glf {

/// Time in a .glf: seconds since 1980 in local time.
/// @param unix_ns nanoseconds since 1970, UTC
/// @param utc_offset_s offset of local time, positive east of Greenwich; 0 for logs in UTC
double glf_time_s(std::int64_t unix_ns, std::int32_t utc_offset_s);

/// Nanoseconds since the Unix epoch, accurate to about 0.25 microseconds. nullopt if the time is NaN or does
/// not fit in 64 bits of nanoseconds.
std::optional<std::int64_t> unix_ns(double glf_time_s, std::int32_t utc_offset_s);

/// Date and time of day on a log's clock, truncated to seconds.
struct CivilTime {
  int year = 1980;  ///< 1980..2107, the range of ZIP; times outside are clamped
  unsigned month = 1;
  unsigned day = 1;
  unsigned hour = 0;
  unsigned minute = 0;
  unsigned second = 0;

  bool operator==(const CivilTime&) const = default;
};
CivilTime civil_time(double glf_time_s);

/// "2026-11-20-142233": the stamp in the file names of a log, from the time of its first record.
std::string log_stamp(double glf_time_s);
std::string log_name(const std::string& stamp);     ///< "log_<stamp>.glf"
std::string dat_name(const std::string& stamp);     ///< "data_<stamp>.dat", also inside the .glf
std::string config_name(const std::string& stamp);  ///< "log_<stamp>.cfg" inside the .glf

}  // namespace sonard::glf
