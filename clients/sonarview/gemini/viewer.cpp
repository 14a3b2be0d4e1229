// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/viewer.hpp"

#include <algorithm>
#include <array>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <csignal>
#include <deque>

#include "clients/sonarview/gemini/sockets.hpp"
#include "clients/sonarview/gemini/watched_head.hpp"

namespace sonard::client {
namespace {

using boost::asio::ip::udp;
using boost::system::error_code;

constexpr std::size_t datagram_buffer_bytes = 2048;  // as in the vendor's libraries
constexpr int datagrams_a_turn = 256;                // per call, so that timers and signals are not delayed

TimePoint now() {
  return std::chrono::steady_clock::now().time_since_epoch();
}

/// The sockets, timer and signals for all viewed heads.
class Viewer {
 public:
  explicit Viewer(const GeminiOptions& options);

  ExitStatus run();

 private:
  void wait_for_reports();
  void on_reports();
  void advance();
  void arm_timer();

  GeminiOptions options_;
  boost::asio::io_context io_;
  udp::socket reports_;
  udp::socket commands_;
  boost::asio::steady_timer timer_{io_};
  TimePoint timer_due_ = TimePoint::max();
  boost::asio::signal_set signals_{io_, SIGINT, SIGTERM};
  std::uint64_t kernel_drops_ = 0;
  std::deque<WatchedHead> heads_;
};

Viewer::Viewer(const GeminiOptions& options)
    : options_(options), reports_(open_report_socket(io_, options.bind_address)), commands_(io_) {
  if (options_.client_address != 0) {
    commands_ = open_command_socket(io_, options_.client_address);
  }
  for (std::size_t number = 0; number < options_.sonar_ids.size(); ++number) {
    heads_.emplace_back(options_, number, commands_);
  }
}

ExitStatus Viewer::run() {
  signals_.async_wait([this](const error_code& cancelled, int) {
    if (!cancelled) {
      for (WatchedHead& head : heads_) {
        head.end();
      }
      io_.stop();
    }
  });
  for (WatchedHead& head : heads_) {
    head.start(now());
  }
  wait_for_reports();
  arm_timer();
  io_.run();
  ExitStatus worst = ExitStatus::ok;
  for (WatchedHead& head : heads_) {
    const ExitStatus status = head.sum_up(kernel_drops_);
    worst = worst == ExitStatus::ok ? status : worst;
  }
  return worst;
}

void Viewer::wait_for_reports() {
  reports_.async_wait(udp::socket::wait_read, [this](const error_code& cancelled) {
    if (!cancelled) {
      on_reports();
      wait_for_reports();
    }
  });
}

void Viewer::on_reports() {
  std::array<std::uint8_t, datagram_buffer_bytes> buffer;
  for (int count = 0; count < datagrams_a_turn; ++count) {
    const auto size = receive(reports_, buffer, kernel_drops_);
    if (!size) {
      break;
    }
    for (WatchedHead& head : heads_) {
      head.on_datagram(now(), std::span(buffer).first(*size));
    }
  }
  advance();
}

void Viewer::advance() {
  const TimePoint at = now();
  for (WatchedHead& head : heads_) {
    if (const auto address = head.address(); address && !commands_.is_open()) {
      options_.client_address = address_towards(*address);
      commands_ = open_command_socket(io_, options_.client_address);
    }
    head.advance(at);
  }
  if (std::ranges::all_of(heads_, &WatchedHead::ended)) {
    io_.stop();
  } else {
    arm_timer();
  }
}

/// Keeps a timer that expires earlier: it calls advance(), which arms it again. So a burst of lines does not
/// re-arm the timer each time.
void Viewer::arm_timer() {
  const TimePoint at = now();
  TimePoint wake = TimePoint::max();
  for (const WatchedHead& head : heads_) {
    wake = head.ended() ? wake : std::min(wake, head.next_wake(at));
  }
  if (wake >= timer_due_) {
    return;
  }
  timer_due_ = wake;
  timer_.expires_at(std::chrono::steady_clock::time_point(wake));
  timer_.async_wait([this](const error_code& cancelled) {
    if (!cancelled) {
      timer_due_ = TimePoint::max();
      advance();
    }
  });
}

}  // namespace

ExitStatus view_gemini(const GeminiOptions& options) {
  return Viewer(options).run();
}

}  // namespace sonard::client
