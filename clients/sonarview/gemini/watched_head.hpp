// SPDX-License-Identifier: Apache-2.0
// One of the heads that sonarview views: its client, its pictures and its messages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <string>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/common/fan_pictures.hpp"
#include "clients/sonarview/common/head_run.hpp"
#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/sockets.hpp"
#include "protocol/gemini/client.hpp"

namespace sonard::client {

/// Drops datagrams of one direction on purpose, to test head and client on a lossy link.
class DatagramDropper {
 public:
  /// @param share 0..1
  /// @param seed the same seed drops the same datagrams of a sequence
  DatagramDropper(double share, std::uint64_t seed) : share_(share), random_(seed) {}

  /// Whether to drop the next datagram.
  bool drop() {
    // Distributions of standard libraries differ; this formula gives the same numbers everywhere.
    const bool lost = static_cast<double>(random_() >> 11) * 0x1p-53 < share_;
    dropped_ += lost ? 1 : 0;
    return lost;
  }
  std::uint64_t dropped() const { return dropped_; }

 private:
  double share_;
  std::mt19937_64 random_;
  std::uint64_t dropped_ = 0;
};

/// Everything runs on the caller's thread, except that pictures are drawn on the writer's thread.
class WatchedHead {
 public:
  /// Starts pinging when a status arrives.
  /// @param number index in GeminiOptions::sonar_ids
  /// @param options, sockets must outlive this object
  /// @throws std::runtime_error (folder for pictures)
  WatchedHead(const GeminiOptions& options, std::size_t number, GeminiSockets& sockets);

  /// Handles a datagram from any head.
  void on_datagram(TimePoint at, std::span<const std::uint8_t> datagram);
  /// Does the work that is due, and ends at a limit.
  /// @throws std::runtime_error (socket for commands)
  void advance(TimePoint at);
  /// When to advance() next.
  TimePoint next_wake() const;
  /// Stops the pings of the head. Further calls have no effect.
  void end();
  bool ended() const { return ended_; }
  /// Finishes the pictures and prints the summary.
  ExitStatus sum_up();

 private:
  void send_commands();
  void take_ping(gemini::ReceivedPing ping);
  void greet() const;
  void check_limits(TimePoint at);
  void give_up(ExitStatus failure, const std::string& why);
  std::string no_head_text() const;
  std::string no_ping_text() const;

  const GeminiOptions& options_;
  const std::uint16_t sonar_id_;
  GeminiSockets& sockets_;
  HeadRun run_;
  gemini::Client client_;
  FanPictures pictures_;
  DatagramDropper drop_rx_, drop_tx_;
  bool send_failed_ = false;
  bool ended_ = false;
};

}  // namespace sonard::client
