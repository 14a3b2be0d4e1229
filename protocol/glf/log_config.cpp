// SPDX-License-Identifier: Apache-2.0
#include "protocol/glf/log_config.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace sonard::glf {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Three decimals with a point, independent of the locale; 0 if the value is not finite.
std::string decimal(double time_s) {
  std::array<char, 400> text{};  // the largest double has 309 digits before its point
  const auto end = std::to_chars(text.data(), text.data() + text.size(), std::isfinite(time_s) ? time_s : 0.0,
                                 std::chars_format::fixed, 3);
  return {text.data(), end.ptr};
}

std::string device_info(const std::vector<std::uint16_t>& device_ids) {
  std::string text;
  for (const std::uint16_t id : device_ids) {
    text += text.empty() ? "Gemini - " : ", Gemini - ";
    text += std::to_string(id);
  }
  return text;
}

}  // namespace

std::string config_xml(const LogConfig& config) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<genesisLog>\n"
         "  <logHeader>\n"
         "    <appName>" +
         escaped(config.app_name) +
         "</appName>\n"
         "    <fileVersion>1</fileVersion>\n"
         "    <creationTime>" +
         decimal(config.creation_time_s) +
         "</creationTime>\n"
         "    <deviceInfo>" +
         device_info(config.device_ids) +
         "</deviceInfo>\n"
         "  </logHeader>\n"
         "  <logTerminator>\n"
         "    <closeTime>" +
         decimal(config.close_time_s) +
         "</closeTime>\n"
         "  </logTerminator>\n"
         "</genesisLog>\n";
}

}  // namespace sonard::glf
