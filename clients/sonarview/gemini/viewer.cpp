// SPDX-License-Identifier: Apache-2.0
// `sonarview gemini`.
#include <poll.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <ctime>
#include <deque>
#include <memory>

#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/sockets.hpp"
#include "clients/sonarview/gemini/watched_head.hpp"

namespace sonard::client {
namespace {

constexpr int datagrams_a_turn = 256;  // so that timers and signals are not delayed

volatile std::sig_atomic_t signalled = 0;

/// SIGINT and SIGTERM set `signalled` while a thread waits with the returned mask, and at no other time. Call
/// before other threads start.
sigset_t hold_signals() {
  sigset_t ends{};
  sigset_t usual{};
  sigemptyset(&ends);
  for (const int signal : {SIGINT, SIGTERM}) {
    sigaddset(&ends, signal);
    std::signal(signal, [](int) { signalled = 1; });
  }
  pthread_sigmask(SIG_BLOCK, &ends, &usual);
  return usual;
}

void wait_for_reports(GeminiSockets& sockets, TimePoint wake, const sigset_t& usual) {
  const auto left = std::max(wake - steady_now(), std::chrono::nanoseconds{});
  const auto whole = std::chrono::floor<std::chrono::seconds>(left);
  const timespec limit{static_cast<std::time_t>(whole.count()), static_cast<long>((left - whole).count())};
  pollfd reports{sockets.reports_descriptor(), POLLIN, 0};
  ppoll(&reports, 1, &limit, &usual);
}

/// Runs until a limit of `options` or a signal.
/// @throws std::runtime_error (a socket, or the folder for pictures)
ExitStatus view(const GeminiOptions& options) {
  const sigset_t usual = hold_signals();
  GeminiSockets sockets(options.bind_address, options.client_address);
  std::deque<WatchedHead> heads;
  for (std::size_t number = 0; number < options.sonar_ids.size(); ++number) {
    heads.emplace_back(options, number, sockets);
  }
  while (signalled == 0 && !std::ranges::all_of(heads, &WatchedHead::ended)) {
    TimePoint wake = TimePoint::max();
    for (const WatchedHead& head : heads) {
      wake = head.ended() ? wake : std::min(wake, head.next_wake());
    }
    wait_for_reports(sockets, wake, usual);
    for (int count = 0; count < datagrams_a_turn; ++count) {
      const auto datagram = sockets.receive();
      if (!datagram) {
        break;
      }
      for (WatchedHead& head : heads) {
        head.on_datagram(steady_now(), *datagram);
      }
    }
    for (WatchedHead& head : heads) {
      head.advance(steady_now());
    }
  }
  ExitStatus worst = ExitStatus::ok;
  for (WatchedHead& head : heads) {
    head.end();
    const ExitStatus status = head.sum_up();
    worst = worst == ExitStatus::ok ? status : worst;
  }
  return worst;
}

constexpr const char* summary =
    "Client for a Gemini 720i that acts as a vehicle: pings, repairs losses, reports rate and loss, writes "
    "pictures.";

constexpr const char* footer = R"(Examples:
  sonarview --range 20 --compression 1 --out out          the head of configs/demo.yaml, until Ctrl-C
  sonarview --continuous 100 --pings 200 --log-pings      a ping every 100 ms, one line per ping
  sonarview --drop-rx 0.05 --drop-tx 0.05 --pings 200     a link that loses 5 % in both directions
  sonarview --client-address 10.61.19.1                  a head on another network

Exit status: 0 all pings complete; 1 a socket or file could not be opened; 2 invalid command line;
3 no head; 4 a ping was incomplete, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<GeminiArguments>(app);
  return [arguments] { return [options = arguments->options()] { return view(options); }; };
}

}  // namespace

const Subcommand& gemini_subcommand() {
  static constexpr Subcommand subcommand{"gemini", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
