// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/json_lines.hpp"

#include <charconv>
#include <chrono>
#include <cmath>
#include <regex>

#include <fmt/chrono.h>
#include <fmt/format.h>

namespace sonard::server {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_text(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    return text;
  }
  const bool whole = text.find_first_of(".eE") == std::string::npos && std::abs(value) < 9e15;
  return whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

/// The key=value pairs of a line. A value ends at a blank, or is in double quotes or brackets.
Json pairs_in(const std::string& line) {
  static const std::regex pair(R"RE((^|\s)([a-z_][a-z0-9_]*)=("[^"]*"|\[[^\]]*\]|[^\s"]+))RE");
  Json pairs = Json::object();
  for (std::sregex_iterator found(line.begin(), line.end(), pair), none; found != none; ++found) {
    std::string value = (*found)[3];
    if (value.starts_with('"')) {
      pairs[(*found)[2]] = value.substr(1, value.size() - 2);
      continue;
    }
    if (value.ends_with(',') || value.ends_with(';')) {
      value.pop_back();  // punctuation of the sentence
    }
    pairs[(*found)[2]] = number_or_text(value);
  }
  return pairs;
}

}  // namespace

Json members_of(std::string_view line) {
  static const std::regex head(R"(^head=([^\s:]+):? ?)");
  static const std::regex area(R"(^([a-z][a-z0-9_-]*)[^=]*?: )");
  Json members;
  std::string text(line);
  std::smatch found;
  if (std::regex_search(text, found, head)) {
    members["head"] = found[1];
    text.erase(0, static_cast<std::size_t>(found.length()));
  } else {
    members["area"] = std::regex_search(text, found, area) ? found[1].str() : "sonard";
  }
  members["message"] = text;
  members["keys"] = pairs_in(text);
  return members;
}

void JsonLines::format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& line) {
  const auto since_epoch = message.time.time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since_epoch).count() % 1000;
  const std::string_view level(spdlog::level::to_string_view(message.level).data(),
                               spdlog::level::to_string_view(message.level).size());
  Json object{{"time", fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03d}Z",
                                   fmt::gmtime(std::chrono::system_clock::to_time_t(message.time)), ms)},
              {"level", level}};
  object.update(members_of({message.payload.data(), message.payload.size()}));
  const std::string text = object.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
  line.append(text.data(), text.data() + text.size());
}

}  // namespace sonard::server
