// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/clock.hpp"

#include <fmt/format.h>

#include "protocol/dvl_a50/json.hpp"
#include "protocol/dvl_a50/utc.hpp"

namespace sonard::dvl_a50 {
namespace {

using std::chrono::microseconds;

constexpr std::int64_t latest_us = 4'000'000'000'000'000;
constexpr std::size_t most_address_bytes = 64;

}  // namespace

std::int64_t Clock::unix_us(TimePoint time) const {
  return std::chrono::floor<microseconds>(time + offset_).count();
}

bool Clock::set_server(std::string_view address) {
  const bool good = !address.empty() && address.size() <= most_address_bytes;
  server_ = good ? address : server_;
  return good;
}

bool Clock::set(TimePoint now, std::optional<std::int64_t> wanted_us) {
  const bool good = wanted_us && *wanted_us >= 0 && *wanted_us <= latest_us;
  offset_ += microseconds{good ? *wanted_us - unix_us(now) : 0};
  return good;
}

std::string Clock::status_json(TimePoint now) const {
  return fmt::format(
      R"({{"system_time":"{}","ntp_synced":{},"ntp_synced_to":{},"ntp_seconds_since_last_sync":{}}})",
      rfc3339(unix_us(now)), synced_, json_text(synced_ ? server_ : ""),
      synced_ ? fmt::format("{}", seconds_since_sync(now)) : "null");
}

std::string Clock::status_sentence(TimePoint now) const {
  return fmt::format("wrs,{},{}", unix_us(now) / 1'000'000,
                     synced_ ? fmt::format("1,{},{}", server_, seconds_since_sync(now)) : "0,,");
}

}  // namespace sonard::dvl_a50
