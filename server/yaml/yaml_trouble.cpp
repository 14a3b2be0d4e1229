// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/yaml_trouble.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/yaml/yaml_unclosed.hpp"

namespace sonard::server {
namespace {

constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz_0123456789";  // of keys

constexpr std::size_t most_quoted = 80;

std::string_view next_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

std::string_view without_comment(std::string_view line) {
  line = line.substr(0, line.find(" #"));
  const std::size_t last = line.find_last_not_of(" \t\r");
  return line.substr(0, last == std::string_view::npos ? 0 : last + 1);
}

std::size_t indent_of(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

/// The columns of the mappings and lists that are open after the lines so far.
class Indents {
 public:
  void add(std::string_view line) {
    std::size_t at = indent_of(line);
    while (!open_.empty() && open_.back() >= at) {
      open_.pop_back();
    }
    open_.push_back(at);
    for (; line.substr(at).starts_with("- "); open_.push_back(at)) {
      at = line.find_first_not_of(' ', at + 1);  // text after a dash is a mapping of its own
    }
    may_go_deeper_ = line.ends_with(':') || line.ends_with('-') || line.ends_with('|') || line.ends_with('>');
  }
  bool allow(std::size_t indent) const {
    return open_.empty() || (may_go_deeper_ && indent > open_.back()) ||
           std::find(open_.begin(), open_.end(), indent) != open_.end();
  }
  const std::vector<std::size_t>& open() const { return open_; }

 private:
  std::vector<std::size_t> open_;
  bool may_go_deeper_ = false;
};

std::string_view word_with_ipv6(std::string_view line) {
  while (!line.empty()) {
    line.remove_prefix(std::min(line.find_first_not_of(" ,"), line.size()));
    const std::string_view word = line.substr(0, line.find_first_of(" ,"));
    if (is_ipv6(word)) {
      return word;
    }
    line.remove_prefix(word.size());
  }
  return {};
}

int column(std::size_t offset) {
  return static_cast<int>(offset) + 1;
}

/// The problem of a key in this line that no blank follows.
std::optional<ConfigProblem> key_without_blank(std::string_view line, int number) {
  for (std::size_t at = 0; at < line.size(); ++at) {
    const std::size_t word = std::min(line.find_first_not_of(" -{,", at), line.size());
    if (std::string why = missing_blank(line.substr(word)); !why.empty()) {
      return ConfigProblem{{number, column(word)}, "", std::move(why)};
    }
    at = std::min(line.find_first_of("{,", word), line.size());
  }
  return std::nullopt;
}

/// The problem of a key at the begin of this line that no colon follows.
std::optional<ConfigProblem> key_without_colon(std::string_view line, int number) {
  const std::size_t word = std::min(line.find_first_not_of(" -"), line.size());
  if (std::string why = missing_colon(line.substr(word)); !why.empty()) {
    return ConfigProblem{{number, column(word)}, "", std::move(why)};
  }
  return std::nullopt;
}

}  // namespace

ConfigProblem yaml_trouble(std::string_view text, SourcePosition at, const std::string& complaint) {
  if (const auto unclosed = find_unclosed(text, at.line)) {
    return *unclosed;
  }
  Indents indents;
  std::optional<ConfigProblem> bad_key;
  for (int number = 1; number <= at.line && !text.empty(); ++number) {
    const std::string_view whole = next_line(text);
    const std::size_t first = std::min(whole.find_first_not_of(" \t"), whole.size());
    if (const std::size_t tab = whole.find('\t'); tab < first && first < whole.size()) {
      return {
          {number, column(tab)}, "", "a tab indents this line (expected spaces; YAML allows no tabs there)"};
    }
    const std::string_view line = without_comment(whole);
    const std::size_t indent = indent_of(line);
    if (indent == line.size() || line[indent] == '#') {
      continue;
    }
    auto found = key_without_blank(line, number);
    found = found ? std::move(found) : key_without_colon(line, number);
    if (found || number < at.line) {
      bad_key = std::move(found);  // the parser rejects the next line
    }
    if (number == at.line) {
      if (bad_key) {
        return *bad_key;
      }
      if (const std::string_view word = word_with_ipv6(line); !word.empty()) {
        return {{number, column(static_cast<std::size_t>(word.data() - whole.data()))},
                "",
                fmt::format("{} is an IPv6 address (expected an IPv4 address; IPv6 is not supported)",
                            in_quotes(word))};
      }
      if (!indents.allow(indent)) {
        return {
            {number, column(indent)},
            "",
            fmt::format("this line is indented by {} space(s), which matches no open section (expected {})",
                        indent, fmt::join(indents.open(), " or "))};
      }
    }
    indents.add(line);
  }
  return bad_key ? *bad_key : ConfigProblem{at, "", fmt::format("{} (expected valid YAML)", complaint)};
}

std::string missing_colon(std::string_view text) {
  const std::size_t end = std::min(text.find_first_not_of(letters), text.size());
  const std::size_t next = std::min(text.find_first_not_of(' ', end), text.size());
  const bool has_sign = text.substr(next).starts_with('=');
  const std::size_t begin = std::min(text.find_first_not_of(" =", next), text.size());
  const std::string_view value = text.substr(begin);
  const bool one_value = has_sign || value.find(' ') == std::string_view::npos || value.starts_with('[') ||
                         value.starts_with('{') || value.starts_with('"') || value.starts_with('\'');
  if (end == 0 || next == text.size() || (next == end && !has_sign) || value.empty() || !one_value ||
      std::isdigit(static_cast<unsigned char>(text[0])) != 0 || text.ends_with(':') ||
      (text.find(": ") != std::string_view::npos && text.find(": ") < text.find_first_of("[{\"'"))) {
    return {};
  }
  return fmt::format("a colon is missing after '{0}' (expected {0}: {1})", text.substr(0, end), value);
}

std::string missing_blank(std::string_view text) {
  const std::size_t end = std::min(text.find_first_not_of(letters), text.size());
  const std::string_view value = text.substr(std::min(end + 1, text.size()));
  if (end == 0 || !text.substr(end).starts_with(':') ||
      std::isdigit(static_cast<unsigned char>(text[0])) != 0 || value.find_first_of(" \t\r,}") == 0 ||
      value.empty() || value.starts_with("//")) {
    return {};
  }
  return fmt::format("{} is one word (expected '{}:' and a value; write a blank after ':')",
                     in_quotes(text.substr(0, text.find_first_of(" ,}"))), text.substr(0, end));
}

std::string with_decimal_point(std::string_view text) {
  const std::size_t comma = text.find(',');
  const std::size_t sign = text.starts_with('-') || text.starts_with('+') ? 1 : 0;
  const auto digits = [](std::string_view part) {
    return !part.empty() &&
           std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c); });
  };
  if (comma == std::string_view::npos || comma < sign || !digits(text.substr(sign, comma - sign)) ||
      !digits(text.substr(comma + 1))) {
    return {};
  }
  return fmt::format("{}.{}", text.substr(0, comma), text.substr(comma + 1));
}

bool is_ipv6(std::string_view text) {
  if (text.starts_with('[')) {
    const std::size_t end = text.find(']');
    text = end == std::string_view::npos ? std::string_view{} : text.substr(1, end - 1);
  }
  text = text.substr(0, text.find('/'));
  text = text.substr(0, text.find('%'));
  in6_addr address{};
  return text.find(':') != std::string_view::npos &&
         inet_pton(AF_INET6, std::string(text).c_str(), &address) == 1;
}

std::string in_quotes(std::string_view text) {
  return text.size() <= most_quoted
             ? fmt::format("'{}'", text)
             : fmt::format("'{}...' ({} characters)", text.substr(0, most_quoted), text.size());
}

}  // namespace sonard::server
