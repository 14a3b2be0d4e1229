// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/json.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace sonard::dvl_a50 {
namespace {

constexpr int most_levels = 16;
constexpr std::string_view blanks = " \t\r\n";

/// @return nullopt if `value` is nested too deeply
std::optional<Json> converted(const nlohmann::ordered_json& value, int level) {
  if (level > most_levels) {
    return std::nullopt;
  }
  if (value.is_array()) {
    Json::List list;
    for (const auto& item : value) {
      std::optional<Json> inner = converted(item, level + 1);
      if (!inner) {
        return std::nullopt;
      }
      list.push_back(*std::move(inner));
    }
    return Json{std::move(list)};
  }
  if (value.is_object()) {
    Json::Members members;
    for (const auto& item : value.items()) {
      std::optional<Json> inner = converted(item.value(), level + 1);
      if (!inner) {
        return std::nullopt;
      }
      members.emplace_back(item.key(), *std::move(inner));
    }
    return Json{std::move(members)};
  }
  if (value.is_boolean()) {
    return Json{value.get<bool>()};
  }
  if (value.is_number()) {
    return Json{value.get<double>()};
  }
  return value.is_string() ? Json{value.get<std::string>()} : Json{nullptr};
}

}  // namespace

const Json* Json::find(std::string_view name) const {
  const auto* const members = as<Members>();
  if (members == nullptr) {
    return nullptr;
  }
  const auto found = std::find_if(members->rbegin(), members->rend(),
                                  [&](const auto& member) { return member.first == name; });
  return found == members->rend() ? nullptr : &found->second;
}

std::optional<Json> parse_json(std::string_view text) {
  const auto parsed = nlohmann::ordered_json::parse(text, nullptr, /*allow_exceptions=*/false);
  return parsed.is_discarded() ? std::nullopt : converted(parsed, 0);
}

std::string json_text(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted += '\\';
    }
    quoted += c >= ' ' && c <= '~' ? c : '?';
  }
  return quoted + '"';
}

std::string json_number(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

void JsonStream::append(std::span<const std::uint8_t> bytes) {
  if (overflowed_ || rest_.size() + bytes.size() > most_bytes) {
    overflowed_ = true;
    std::string().swap(rest_);
    return;
  }
  if (rest_.size() + bytes.size() > most_bytes / 2) {
    rest_.reserve(most_bytes);
  }
  rest_.append(bytes.begin(), bytes.end());
}

std::optional<std::string> JsonStream::next() {
  while (scanned_ < rest_.size()) {
    const char c = rest_[scanned_++];
    if (depth_ == 0 && c != '{') {
      dropped_ += blanks.find(c) == std::string_view::npos ? 1 : 0;
      continue;
    }
    if (in_text_) {
      in_text_ = escaped_ || c != '"';
      escaped_ = !escaped_ && c == '\\';
      continue;
    }
    in_text_ = c == '"';
    if (c == '{' && depth_++ == 0) {
      rest_.erase(0, scanned_ - 1);
      scanned_ = 1;
    } else if (c == '}' && --depth_ == 0) {
      std::string object = rest_.substr(0, scanned_);
      rest_.erase(0, std::exchange(scanned_, 0));
      return object;
    }
  }
  if (depth_ == 0) {
    rest_.clear();
    scanned_ = 0;
  }
  return std::nullopt;
}

}  // namespace sonard::dvl_a50
