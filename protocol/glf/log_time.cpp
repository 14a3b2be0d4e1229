// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/log_time.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace sonard::glf {
namespace {

constexpr std::int64_t ns_per_s = 1'000'000'000;
constexpr std::int64_t epoch_unix_s = 315'532'800;  // 1980-01-01 00:00:00
constexpr std::int64_t last_zip_s = 4'039'286'399;  // 2107-12-31 23:59:59

}  // namespace

double glf_time_s(std::int64_t unix_ns, std::int32_t utc_offset_s) {
  // Converts whole seconds separately, because a double cannot hold all nanoseconds.
  const std::int64_t seconds = unix_ns / ns_per_s;
  const std::int64_t rest_ns = unix_ns % ns_per_s;
  return static_cast<double>(seconds - epoch_unix_s + utc_offset_s) + static_cast<double>(rest_ns) * 1e-9;
}

std::optional<std::int64_t> unix_ns(double glf_time_s, std::int32_t utc_offset_s) {
  constexpr double limit_s = 8e9;  // 2^63 ns are 9.2e9 s
  if (!(std::abs(glf_time_s) < limit_s)) {
    return std::nullopt;
  }
  const double whole_s = std::floor(glf_time_s);
  const auto rest_ns = static_cast<std::int64_t>(std::llround((glf_time_s - whole_s) * 1e9));
  return (static_cast<std::int64_t>(whole_s) + epoch_unix_s - utc_offset_s) * ns_per_s + rest_ns;
}

CivilTime civil_time(double glf_time_s) {
  using namespace std::chrono;
  const double held_s = glf_time_s > 0.0 ? std::min(glf_time_s, static_cast<double>(last_zip_s)) : 0.0;
  const sys_seconds time{seconds{epoch_unix_s + static_cast<std::int64_t>(held_s)}};
  const auto midnight = floor<days>(time);
  const year_month_day date{midnight};
  const hh_mm_ss clock{time - midnight};
  return {.year = static_cast<int>(date.year()),
          .month = static_cast<unsigned>(date.month()),
          .day = static_cast<unsigned>(date.day()),
          .hour = static_cast<unsigned>(clock.hours().count()),
          .minute = static_cast<unsigned>(clock.minutes().count()),
          .second = static_cast<unsigned>(clock.seconds().count())};
}

std::string log_stamp(double glf_time_s) {
  const CivilTime t = civil_time(glf_time_s);
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%04d-%02u-%02u-%02u%02u%02u", t.year, t.month, t.day, t.hour,
                t.minute, t.second);
  return text.data();
}

std::string log_name(const std::string& stamp) {
  return "log_" + stamp + ".glf";
}

std::string dat_name(const std::string& stamp) {
  return "data_" + stamp + ".dat";
}

std::string config_name(const std::string& stamp) {
  return "log_" + stamp + ".cfg";
}

}  // namespace sonard::glf
