// SPDX-License-Identifier: Apache-2.0
// Rate-limited log lines that a peer can cause.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <spdlog/common.h>

#include "server/clock/clock.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

/// For one source of such lines: the clients of a port, the settings of a head. `burst` lines may come at
/// once, and one more every `refill`. Further lines are dropped and counted, and the next line gives their
/// number. The first line of each reason (Reasons) is always logged. If there is no memory for a line, the
/// line is dropped and counted, too. Belongs to one thread.
class PeerLog {
 public:
  static constexpr int burst = 10;
  static constexpr std::chrono::seconds refill{2};

  /// @param clock must outlive this object
  explicit PeerLog(const Clock& clock = real_time()) : clock_(clock) {}

  template <typename... Args>
  void info(fmt::format_string<Args...> format, Args&&... args) {
    say(spdlog::level::info, format, fmt::make_format_args(args...));
  }
  template <typename... Args>
  void warn(fmt::format_string<Args...> format, Args&&... args) {
    say(spdlog::level::warn, format, fmt::make_format_args(args...));
  }
  template <typename... Args>
  void error(fmt::format_string<Args...> format, Args&&... args) {
    say(spdlog::level::err, format, fmt::make_format_args(args...));
  }

 private:
  static const Clock& real_time();
  void say(spdlog::level::level_enum level, fmt::string_view format, fmt::format_args args);
  void say(spdlog::level::level_enum level, const std::string& text);

  const Clock& clock_;
  Reasons reasons_;
  int tokens_ = burst;
  TimePoint refilled_at_{};
  std::uint64_t left_out_ = 0;
  bool lacked_memory_ = false;  ///< for a line of these
};

}  // namespace sonard::server
