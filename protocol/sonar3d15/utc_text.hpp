// SPDX-License-Identifier: Apache-2.0
// Times as text: RFC 3339.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace sonard::sonar3d15 {

/// "2026-01-01T00:00:00.250000Z". @param utc since 1970
std::string utc_text(std::chrono::nanoseconds utc);

/// Since 1970; nullopt if `text` is not a time from 1970 to 2199. Accepts up to 9 digits of a second, and any
/// offset from UTC.
std::optional<std::chrono::nanoseconds> parse_utc(const std::string& text);

}  // namespace sonard::sonar3d15
