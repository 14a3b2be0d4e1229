// SPDX-License-Identifier: Apache-2.0
// The clock of logs, and the names of files that follow from it. Source: docs/logs.md 1.1, 1.6.
// A log counts seconds since 1980-01-01 00:00:00 of local time and does not say which zone that is, so the
// offset of the zone from UTC is an argument: fix it when a log is opened, for local time jumps.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sonard::glf {

/// Seconds of a .glf since 1980, in local time.
/// @param unix_ns nanoseconds since 1970, UTC
/// @param utc_offset_s of local time, positive east of Greenwich; 0 for logs in UTC
double glf_time_s(std::int64_t unix_ns, std::int32_t utc_offset_s);

/// Time since the Unix epoch, to about a quarter of a microsecond. nullopt for what is no time: not a number,
/// or more than 64 bits of nanoseconds.
std::optional<std::int64_t> unix_ns(double glf_time_s, std::int32_t utc_offset_s);

/// A date and a time of day as a log's clock shows it, cut to whole seconds.
struct CivilTime {
  int year = 1980;  ///< 1980..2107, the years a ZIP can name; times beyond are held to its ends
  unsigned month = 1;
  unsigned day = 1;
  unsigned hour = 0;
  unsigned minute = 0;
  unsigned second = 0;

  bool operator==(const CivilTime&) const = default;
};
CivilTime civil_time(double glf_time_s);

/// "2026-11-20-142233": what the names of a log are made of, from the time of its first record.
std::string log_stamp(double glf_time_s);
std::string log_name(const std::string& stamp);     ///< "log_<stamp>.glf"
std::string dat_name(const std::string& stamp);     ///< "data_<stamp>.dat", also inside the .glf
std::string config_name(const std::string& stamp);  ///< "log_<stamp>.cfg" inside the .glf

}  // namespace sonard::glf
