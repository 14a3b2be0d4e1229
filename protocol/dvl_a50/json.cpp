// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/json.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace sonard::dvl_a50 {
namespace {

constexpr int most_levels = 16;
constexpr std::string_view blanks = " \t\r\n";

class Parser {
 public:
  explicit Parser(std::string_view text) : rest_(text) {}

  std::optional<Json> whole() {
    std::optional<Json> value = parse_value(0);
    skip_blanks();
    return rest_.empty() ? value : std::nullopt;
  }

 private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size())); }
  bool take(std::string_view text) {
    const bool here = rest_.starts_with(text);
    rest_.remove_prefix(here ? text.size() : 0);
    return here;
  }
  bool take_sign(std::string_view sign) {
    skip_blanks();
    return take(sign);
  }

  std::optional<Json> parse_value(int level) {
    skip_blanks();
    if (rest_.empty() || level > most_levels) {
      return std::nullopt;
    }
    switch (rest_.front()) {
      case '{':
        return parse_object(level);
      case '[':
        return parse_list(level);
      case '"':
        return wrapped(parse_text());
      default:
        break;
    }
    if (take("null")) {
      return Json{nullptr};
    }
    if (take("true")) {
      return Json{true};
    }
    if (take("false")) {
      return Json{false};
    }
    return wrapped(parse_number());
  }

  template <class T>
  static std::optional<Json> wrapped(std::optional<T> value) {
    return value ? std::optional<Json>(Json{*std::move(value)}) : std::nullopt;
  }

  std::optional<double> parse_number() {
    if (rest_.front() != '-' && (rest_.front() < '0' || rest_.front() > '9')) {
      return std::nullopt;
    }
    double number = 0.0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (error != std::errc{} || !std::isfinite(number)) {
      return std::nullopt;
    }
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return number;
  }

  /// Escaped characters beyond ASCII become question marks: no name or value of the protocol has them.
  std::optional<std::string> parse_text() {
    std::string text;
    for (rest_.remove_prefix(1); !rest_.empty(); rest_.remove_prefix(1)) {
      const char c = rest_.front();
      if (c == '"') {
        rest_.remove_prefix(1);
        return text;
      }
      if (c != '\\') {
        text += c;
        continue;
      }
      rest_.remove_prefix(1);
      if (rest_.empty()) {
        return std::nullopt;
      }
      if (rest_.front() != 'u') {
        constexpr std::string_view letters = "bfnrt", meant = "\b\f\n\r\t";
        const std::size_t letter = letters.find(rest_.front());
        text += letter == std::string_view::npos ? rest_.front() : meant[letter];
        continue;
      }
      unsigned code = 0;
      const char* const digits = rest_.data() + 1;
      if (rest_.size() < 5 || std::from_chars(digits, digits + 4, code, 16).ptr != digits + 4) {
        return std::nullopt;
      }
      text += code < 128 ? static_cast<char>(code) : '?';
      rest_.remove_prefix(4);
    }
    return std::nullopt;
  }

  std::optional<Json> parse_list(int level) {
    Json::List list;
    rest_.remove_prefix(1);
    if (take_sign("]")) {
      return Json{std::move(list)};
    }
    do {
      std::optional<Json> item = parse_value(level + 1);
      if (!item) {
        return std::nullopt;
      }
      list.push_back(*std::move(item));
    } while (take_sign(","));
    return take_sign("]") ? std::optional<Json>(Json{std::move(list)}) : std::nullopt;
  }

  std::optional<Json> parse_object(int level) {
    Json::Members members;
    rest_.remove_prefix(1);
    if (take_sign("}")) {
      return Json{std::move(members)};
    }
    do {
      skip_blanks();
      std::optional<std::string> name = rest_.starts_with('"') ? parse_text() : std::optional<std::string>();
      std::optional<Json> value = name && take_sign(":") ? parse_value(level + 1) : std::nullopt;
      if (!value) {
        return std::nullopt;
      }
      members.emplace_back(*std::move(name), *std::move(value));
    } while (take_sign(","));
    return take_sign("}") ? std::optional<Json>(Json{std::move(members)}) : std::nullopt;
  }

  std::string_view rest_;
};

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
  return Parser(text).whole();
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
