// SPDX-License-Identifier: Apache-2.0
// Dates and times of day from microseconds since 1970 (UTC).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sonard::dvl_a50 {

struct Utc {
  int year = 1970, month = 1, day = 1, hour = 0, minute = 0, second = 0, microsecond = 0;
};
Utc utc_of(std::int64_t unix_us);

/// "2026-01-01T00:00:00.250000Z"
std::string rfc3339(std::int64_t unix_us);
/// With "Z" or an offset such as "+02:00"; nullopt: not such a text.
std::optional<std::int64_t> parse_rfc3339(std::string_view text);

}  // namespace sonard::dvl_a50
