// SPDX-License-Identifier: Apache-2.0
#include "common/command_line/help_formatter.hpp"

#include <regex>

#include <fmt/format.h>

namespace sonard {

std::string value_text(const std::string& type) {
  constexpr std::size_t longest_limit = 6;  // longer limits, like 1e+06 or 2^53, do not help a reader
  static const std::regex range(R"(in \[(\S+) - (\S+)\])");
  std::smatch found;
  // Range | IsMember
  static const std::regex range_or_words(R"(in \[(\S+) - (\S+)\].* OR .*\{(.*)\})");
  if (std::regex_search(type, found, range_or_words)) {
    return fmt::format("{}..{} or {}", found[1].str(), found[2].str(), found[3].str());
  }
  if (const std::size_t brace = type.find('{'); brace != std::string::npos) {
    return type.substr(brace, type.find('}') - brace + 1);
  }
  const bool number = type.starts_with("FLOAT") || type.starts_with("INT") || type.starts_with("UINT");
  if (std::regex_search(type, found, range)) {
    const std::string low = found[1];
    const std::string high = found[2];
    const bool shown = low.size() <= longest_limit && high.size() <= longest_limit &&
                       (low + high).find('e') == std::string::npos;
    return shown ? fmt::format("{}..{}", low, high) : "NUMBER";
  }
  return number ? "NUMBER" : type;
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0) {
    return "";  // flags have no value
  }
  std::string text = " " + value_text(option->get_type_name());
  if (const std::string& value = option->get_default_str(); !value.empty()) {
    text += value.starts_with('[') ? " " + value : " [" + value + "]";  // lists have brackets already
  }
  if (option->get_expected_min() > 1) {
    text += fmt::format(" x {}", option->get_expected_min());
  }
  return text + (option->get_required() ? " REQUIRED" : "");
}

}  // namespace sonard
