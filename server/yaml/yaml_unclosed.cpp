// SPDX-License-Identifier: Apache-2.0
#include "server/yaml/yaml_unclosed.hpp"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr auto npos = std::string_view::npos;

/// Reads a text character by character, enough to recognise quotes and brackets.
class Scanner {
 public:
  Scanner(std::string_view text, int last_line) : text_(text), last_line_(last_line) {}

  std::optional<ConfigProblem> run();

 private:
  struct Bracket {
    SourcePosition at;
    std::size_t indent = 0;  ///< of its line
    char closing = ']';
  };

  SourcePosition here() const { return {line_, static_cast<int>(at_ - line_begin_) + 1}; }
  char next_char() const { return at_ + 1 < text_.size() ? text_[at_ + 1] : '\n'; }
  bool before_blank() const { return next_char() == ' ' || next_char() == '\n' || next_char() == '\r'; }
  void begin_line();
  void skip_to_end_of_line() { at_ = std::min(text_.find('\n', at_), text_.size()) - 1; }
  std::size_t closing_quote(char quote) const;
  bool more_follows(std::size_t end) const;
  std::optional<ConfigProblem> take_quoted(char quote);
  bool leaves_bracket() const;
  void take_plain(char c);

  std::string_view text_;
  int last_line_;
  std::size_t at_ = 0, line_begin_ = 0;
  int line_ = 1;
  bool value_begins_ = true;  ///< a quote here opens a quoted text
  std::vector<Bracket> open_;
};

void Scanner::begin_line() {
  ++line_;
  line_begin_ = at_ + 1;
  value_begins_ = true;
}

/// Place of the quote that closes the quote at at_; npos if there is no such quote.
std::size_t Scanner::closing_quote(char quote) const {
  for (std::size_t i = at_ + 1; i < text_.size(); ++i) {
    if (quote == '"' && text_[i] == '\\') {
      ++i;
    } else if (text_[i] == quote) {
      if (quote == '"' || i + 1 == text_.size() || text_[i + 1] != quote) {
        return i;
      }
      ++i;  // '' means one quote
    }
  }
  return npos;
}

/// Whether the text after a closing quote cannot follow one.
bool Scanner::more_follows(std::size_t end) const {
  const std::size_t next = text_.find_first_not_of(" \t", end + 1);
  return next != npos && std::string_view("\r\n#,]}:").find(text_[next]) == npos;
}

std::optional<ConfigProblem> Scanner::take_quoted(char quote) {
  const std::size_t end = closing_quote(quote);
  const std::string_view quoted = text_.substr(at_, end == npos ? npos : end - at_);
  if (end == npos || (quoted.find('\n') != npos && more_follows(end))) {
    return ConfigProblem{
        here(), "",
        fmt::format("the quote that begins here is not closed (expected another {} at its end)", quote)};
  }
  if (quoted.find('\n') == npos && more_follows(end)) {
    return ConfigProblem{
        {line_, static_cast<int>(end - line_begin_) + 1},
        "",
        fmt::format("this quote ends the text that begins in column {} (expected {} for a quote in the text)",
                    here().column, quote == '"' ? "\\\"" : "two single quotes, '',")};
  }
  line_ += static_cast<int>(std::ranges::count(quoted, '\n'));
  if (const std::size_t last = quoted.rfind('\n'); last != npos) {
    line_begin_ = at_ + last + 1;
  }
  at_ = end;
  value_begins_ = false;
  return std::nullopt;
}

/// Whether this line begins with a key or an item at the indent of the bracket's line, or less.
bool Scanner::leaves_bracket() const {
  const std::string_view rest = text_.substr(at_, text_.find('\n', at_) - at_);
  const std::size_t colon = rest.find(':');
  const bool key = colon != npos && rest.find_first_of("[]{},'\" ") > colon;
  return at_ - line_begin_ <= open_.back().indent && (key || rest.starts_with("- "));
}

void Scanner::take_plain(char c) {
  if (value_begins_ && (c == '[' || c == '{')) {
    const std::size_t indent = text_.find_first_not_of(' ', line_begin_) - line_begin_;
    open_.push_back({here(), indent, c == '[' ? ']' : '}'});
  } else if (!open_.empty() && (c == ']' || c == '}')) {
    open_.pop_back();
    value_begins_ = false;
  } else {
    const bool dash = c == '-' && value_begins_ && before_blank();
    value_begins_ = dash || (c == ':' && before_blank()) || (c == ',' && !open_.empty());
  }
}

std::optional<ConfigProblem> Scanner::run() {
  for (; at_ < text_.size() && line_ <= last_line_; ++at_) {
    const char c = text_[at_];
    const bool first = text_.find_first_not_of(" \t", line_begin_) == at_;
    if (c == '\n') {
      begin_line();
    } else if (c == '#' && (first || text_[at_ - 1] == ' ')) {
      skip_to_end_of_line();
    } else if (first && !open_.empty() && leaves_bracket()) {
      break;
    } else if (value_begins_ && (c == '"' || c == '\'')) {
      if (const auto problem = take_quoted(c)) {
        return problem;
      }
    } else if (c != ' ' && c != '\t' && c != '\r') {
      take_plain(c);
    }
  }
  const bool ended = at_ >= text_.size() || line_ <= last_line_;
  if (open_.empty() || !ended) {
    return std::nullopt;
  }
  return ConfigProblem{
      open_.back().at, "",
      fmt::format("the bracket that begins here is not closed (expected {})", open_.back().closing)};
}

}  // namespace

std::optional<ConfigProblem> find_endless_quote(std::string_view text) {
  for (const char quote : {'\'', '"'}) {
    const std::size_t last = text.rfind(quote);
    if (last == npos) {
      continue;
    }
    const auto line = static_cast<int>(std::ranges::count(text.substr(0, last), '\n')) + 1;
    const std::size_t column = last - (text.substr(0, last).rfind('\n') + 1) + 1;  // npos + 1 is 0
    auto found = find_unclosed(text, line);
    if (found && found->at.line == line && found->at.column == static_cast<int>(column)) {
      return found;
    }
  }
  return std::nullopt;
}

std::optional<ConfigProblem> find_unclosed(std::string_view text, int last_line) {
  return Scanner(text, last_line).run();
}

}  // namespace sonard::server
