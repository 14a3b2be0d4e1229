// SPDX-License-Identifier: Apache-2.0
#include "server/daemon/process.hpp"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <system_error>

namespace sonard::server {
namespace {

// Read by the signal handler, which must not block.
std::atomic<int> write_end{-1};
std::atomic<std::int64_t> grace_ns{0};
std::atomic<std::int64_t> deadly_from_ns{0};  // 0: no SIGINT or SIGTERM yet
static_assert(std::atomic<std::int64_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

std::int64_t monotonic_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

extern "C" void on_signal(int signal) {
  const int error = errno;
  bool passed_on = true;
  if (signal != SIGHUP) {
    std::int64_t deadly_from = 0;
    const std::int64_t now = monotonic_ns();
    passed_on = deadly_from_ns.compare_exchange_strong(deadly_from, now + grace_ns);
    if (!passed_on && now >= deadly_from) {
      std::signal(signal, SIG_DFL);
      std::raise(signal);  // takes effect when this handler returns
    }
  }
  const auto number = static_cast<std::uint8_t>(signal);
  if (passed_on && ::write(write_end, &number, 1) != 1) {
    // The pipe is full: enough bytes wait to be read.
  }
  errno = error;
}

}  // namespace

void open_standard_descriptors() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
      // Takes the lowest free number, which is this one.
      static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_RDONLY : O_WRONLY));
    }
  }
}

void ignore_harmless_signals() {
  for (const int signal : {SIGPIPE, SIGHUP, SIGUSR1, SIGUSR2}) {
    std::signal(signal, SIG_IGN);
  }
}

namespace {

void mask_orders_to_end(int how) {
  sigset_t orders;
  sigemptyset(&orders);
  sigaddset(&orders, SIGINT);
  sigaddset(&orders, SIGTERM);
  pthread_sigmask(how, &orders, nullptr);
}

}  // namespace

bool ordered_to_end() {
  return deadly_from_ns != 0;
}

void hold_orders_to_end() {
  mask_orders_to_end(SIG_BLOCK);
}

void let_orders_to_end() {
  mask_orders_to_end(SIG_UNBLOCK);
}

void tell_service_manager(std::string_view line) {
  const char* const path = std::getenv("NOTIFY_SOCKET");
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t length = path == nullptr ? 0 : std::strlen(path);
  if (length < 2 || length >= sizeof(address.sun_path)) {
    return;
  }
  std::memcpy(address.sun_path, path, length);
  if (path[0] == '@') {
    address.sun_path[0] = '\0';  // abstract namespace
  }
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket >= 0) {
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
    // Errors are ignored: the manager then notices by its own time-out.
    static_cast<void>(::sendto(socket, line.data(), line.size(), MSG_NOSIGNAL,
                               reinterpret_cast<const sockaddr*>(&address), size));
    ::close(socket);
  }
}

int catch_signals(std::chrono::nanoseconds grace) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_NONBLOCK | O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "cannot make a pipe for signals");
  }
  const int before = write_end.exchange(ends[1]);
  if (before >= 0) {
    close(before);
  }
  grace_ns = grace.count();
  deadly_from_ns = 0;
  struct sigaction action {};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    sigaction(signal, &action, nullptr);
  }
  return ends[0];
}

}  // namespace sonard::server
