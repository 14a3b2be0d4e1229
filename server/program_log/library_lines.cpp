// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/library_lines.hpp"

#include <iostream>
#include <mutex>
#include <streambuf>
#include <string>

#include "server/program_log/peer_log.hpp"

namespace sonard::server {
namespace {

/// Joins characters to lines. std::cerr flushes after each output, so a line arrives in pieces.
class LineBuffer final : public std::streambuf {
 public:
  void log(std::string_view library, std::string_view text) {
    const std::scoped_lock lock(mutex_);
    log_.warn("{}: {}", library, text);
  }

 private:
  static constexpr std::size_t longest = 1000;

  int_type overflow(int_type c) override {
    const char character = traits_type::to_char_type(c);
    xsputn(&character, traits_type::eq_int_type(c, traits_type::eof()) ? 0 : 1);
    return traits_type::not_eof(c);
  }

  std::streamsize xsputn(const char* text, std::streamsize length) override {
    const std::scoped_lock lock(mutex_);
    for (const char c : std::string_view(text, static_cast<std::size_t>(length))) {
      if (c != '\n' && line_.size() < longest) {
        line_ += c;
      } else if (c == '\n' && !line_.empty()) {
        log_.warn("library: {}", line_);
        line_.clear();
      }
    }
    return length;
  }

  std::mutex mutex_;
  std::string line_;
  PeerLog log_;
};

/// Never destroyed: libraries print until the process ends.
LineBuffer& lines() {
  static LineBuffer* const buffer = new LineBuffer;
  return *buffer;
}

}  // namespace

void take_library_lines() {
  std::cerr.rdbuf(&lines());
}

void log_library_line(std::string_view library, std::string_view text) {
  lines().log(library, text);
}

}  // namespace sonard::server
