// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/stderr_sink.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <mutex>
#include <new>
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

void StderrSink::drop_line() {
  const std::lock_guard lock(mutex_);
  ++out_of_memory_;
}

void StderrSink::sink_it_(const spdlog::details::log_msg& message) {
  try {
    write_line(message);
  } catch (const std::bad_alloc&) {
    ++out_of_memory_;
  }
}

void StderrSink::write_line(const spdlog::details::log_msg& message) {
  const std::string payload = printable({message.payload.data(), message.payload.size()});
  spdlog::details::log_msg safe = message;
  safe.payload = payload;
  spdlog::memory_buf_t line;
  formatter_->format(safe, line);
  std::string text = cut_ ? "\n" : "";
  if (dropped_ + out_of_memory_ > 0) {
    text += dropped_text(message);
  }
  text.append(line.data(), line.size());
  cut_ = false;
  if (write(text)) {
    dropped_ = out_of_memory_ = 0;
  } else {
    ++dropped_;
  }
}

/// Formatted like the lines around it.
std::string StderrSink::dropped_text(const spdlog::details::log_msg& next) {
  const char* const why = out_of_memory_ == 0 ? "stderr was blocked"
                          : dropped_ == 0     ? "memory ran out"
                                              : "stderr was blocked and memory ran out";
  const std::string text =
      fmt::format("log: {} lines were dropped, because {}", dropped_ + out_of_memory_, why);
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
