// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/stderr_sink.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "common/text/printable.hpp"

namespace sonard::server {

StderrSink::StderrSink(int descriptor) : descriptor_(descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0 || S_ISREG(status.st_mode)) {
    return;
  }
  if (S_ISSOCK(status.st_mode)) {
    kind_ = Kind::socket;
    return;
  }
  kind_ = Kind::polled;
  // O_NONBLOCK belongs to the open file, which a shell may share. Opened again, the file is ours alone.
  const std::string path = fmt::format("/proc/self/fd/{}", descriptor);
  const int own = open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (own >= 0) {
    kind_ = Kind::own;
    descriptor_ = own;
  }
}

StderrSink::~StderrSink() {
  if (kind_ == Kind::own) {
    close(descriptor_);
  }
}

void StderrSink::sink_it_(const spdlog::details::log_msg& message) {
  const std::string payload = printable({message.payload.data(), message.payload.size()});
  spdlog::details::log_msg safe = message;
  safe.payload = payload;
  spdlog::memory_buf_t line;
  formatter_->format(safe, line);
  std::string text = std::exchange(cut_, false) ? "\n" : "";
  if (dropped_ > 0) {
    text += dropped_text(message);
  }
  text.append(line.data(), line.size());
  if (write(text)) {
    dropped_ = 0;
  } else {
    ++dropped_;
  }
}

/// Formatted like the lines around it.
std::string StderrSink::dropped_text(const spdlog::details::log_msg& next) {
  const std::string text = fmt::format("log: {} lines were dropped, because stderr was blocked", dropped_);
  spdlog::memory_buf_t line;
  formatter_->format({next.time, {}, next.logger_name, spdlog::level::warn, text}, line);
  return {line.data(), line.size()};
}

bool StderrSink::write(std::string_view text) {
  if (kind_ == Kind::polled) {
    pollfd room{descriptor_, POLLOUT, 0};
    if (poll(&room, 1, /*timeout=*/0) != 1 || (room.revents & POLLOUT) == 0) {
      return false;
    }
    cut_ = text.size() > PIPE_BUF;
    text = text.substr(0, PIPE_BUF);  // poll() guarantees that much room
  }
  ssize_t written = 0;
  do {
    written = kind_ == Kind::socket ? send(descriptor_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                                    : ::write(descriptor_, text.data(), text.size());
  } while (written < 0 && errno == EINTR);
  cut_ = cut_ || (written > 0 && static_cast<std::size_t>(written) < text.size());
  return written > 0;
}

}  // namespace sonard::server
