// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/utc.hpp"

#include <charconv>
#include <chrono>

#include <fmt/format.h>

namespace sonard::dvl_a50 {
namespace {

using std::chrono::microseconds;
using Days = std::chrono::sys_days;

/// Takes the digits of a number of fixed width and the sign that follows, one of `signs`.
std::optional<int> take(std::string_view& text, std::size_t digits, std::string_view signs) {
  int number = 0;
  if (text.size() <= digits ||
      std::from_chars(text.data(), text.data() + digits, number).ptr != text.data() + digits ||
      text.front() == '-' || signs.find(text[digits]) == std::string_view::npos) {
    return std::nullopt;
  }
  text.remove_prefix(digits + 1);
  return number;
}

}  // namespace

Utc utc_of(std::int64_t unix_us) {
  const std::chrono::sys_time<microseconds> time{microseconds{unix_us}};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date{day};
  const std::chrono::hh_mm_ss clock{time - day};
  return {static_cast<int>(date.year()),
          static_cast<int>(static_cast<unsigned>(date.month())),
          static_cast<int>(static_cast<unsigned>(date.day())),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count()),
          static_cast<int>(clock.subseconds().count())};
}

std::string rfc3339(std::int64_t unix_us) {
  const Utc utc = utc_of(unix_us);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:06}Z", utc.year, utc.month, utc.day, utc.hour,
                     utc.minute, utc.second, utc.microsecond);
}

std::optional<std::int64_t> parse_rfc3339(std::string_view text) {
  const auto year = take(text, 4, "-"), month = take(text, 2, "-"), day = take(text, 2, "Tt ");
  const auto hour = take(text, 2, ":"), minute = take(text, 2, ":");
  const std::string_view from_second = text;
  const auto second = take(text, 2, ".Zz+-");
  if (!year || !month || !day || !hour || !minute || !second || *hour > 23 || *minute > 59 || *second > 60) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year{*year},
                                         std::chrono::month{static_cast<unsigned>(*month)},
                                         std::chrono::day{static_cast<unsigned>(*day)}};
  if (!date.ok()) {
    return std::nullopt;
  }
  text = from_second.substr(2);
  std::int64_t fraction_us = 0;
  if (text.front() == '.') {
    text.remove_prefix(1);
    for (std::int64_t unit_us = 100'000; !text.empty() && text.front() >= '0' && text.front() <= '9';
         unit_us /= 10) {
      fraction_us += unit_us * (text.front() - '0');
      text.remove_prefix(1);
    }
  }
  std::int64_t offset_min = 0;
  if (text.size() == 6 && (text[0] == '+' || text[0] == '-')) {
    const int sign = text[0] == '+' ? 1 : -1;
    const std::string zone = std::string(text.substr(1)) + ".";
    std::string_view rest = zone;
    const auto hours = take(rest, 2, ":"), minutes = take(rest, 2, ".");
    if (!hours || !minutes) {
      return std::nullopt;
    }
    offset_min = sign * (60 * *hours + *minutes);
  } else if (text != "Z" && text != "z") {
    return std::nullopt;
  }
  const auto midnight = std::chrono::duration_cast<microseconds>(Days{date}.time_since_epoch()).count();
  return midnight + ((60 * *hour + *minute - offset_min) * 60 + *second) * 1'000'000 + fraction_us;
}

}  // namespace sonard::dvl_a50
