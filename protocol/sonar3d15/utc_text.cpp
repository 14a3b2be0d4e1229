// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/utc_text.hpp"

#include <ctime>
#include <regex>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace sonard::sonar3d15 {

using namespace std::chrono;

std::string utc_text(nanoseconds utc) {
  const auto whole = floor<seconds>(utc);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:06}Z", fmt::gmtime(static_cast<std::time_t>(whole.count())),
                     duration_cast<microseconds>(utc - whole).count());
}

std::optional<nanoseconds> parse_utc(const std::string& text) {
  static const std::regex form(
      R"((\d{4})-(\d\d)-(\d\d)[Tt ](\d\d):(\d\d):(\d\d)(?:\.(\d{1,9}))?(?:[Zz]|([+-])(\d\d):(\d\d)))");
  constexpr std::size_t longest = 35;
  std::smatch parts;
  if (text.size() > longest || !std::regex_match(text, parts, form)) {
    return std::nullopt;
  }
  const auto number = [&parts](std::size_t i) { return parts[i].matched ? std::stoi(parts[i]) : 0; };
  const year_month_day date{year{number(1)}, month{static_cast<unsigned>(number(2))},
                            day{static_cast<unsigned>(number(3))}};
  if (!date.ok() || number(1) < 1970 || number(1) > 2199 || number(4) > 23 || number(5) > 59 ||
      number(6) > 60 || number(9) > 23 || number(10) > 59) {
    return std::nullopt;
  }
  const std::string digits = parts[7].str() + std::string(9 - parts[7].str().size(), '0');
  const minutes ahead = (parts[8] == "-" ? -1 : 1) * (hours{number(9)} + minutes{number(10)});
  return sys_days{date}.time_since_epoch() + hours{number(4)} + minutes{number(5)} + seconds{number(6)} +
         nanoseconds{std::stoi(digits)} - ahead;
}

}  // namespace sonard::sonar3d15
