// SPDX-License-Identifier: Apache-2.0
// One of the heads that sonarview views: its client, its pictures and its messages.
#pragma once

#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/gemini/datagram_dropper.hpp"
#include "clients/sonarview/gemini/gemini_pictures.hpp"
#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/ping_log.hpp"
#include "protocol/gemini/client.hpp"

namespace sonard::client {

/// Everything runs on the caller's thread, except that pictures are drawn on the writer's thread.
class WatchedHead {
 public:
  /// @param number index in GeminiOptions::sonar_ids
  /// @param commands socket for commands; must outlive this object
  /// @throws std::runtime_error (folder for pictures)
  WatchedHead(const GeminiOptions& options, std::size_t number, boost::asio::ip::udp::socket& commands);

  void start(TimePoint at);
  /// Handles a datagram from any head.
  void on_datagram(TimePoint at, std::span<const std::uint8_t> datagram);
  /// Does the work that is due, and ends at a limit.
  void advance(TimePoint at);
  /// Stops the pings of the head. Further calls have no effect.
  void end();
  bool ended() const { return ended_; }
  /// The address of the head; nullopt before its first status.
  std::optional<Ipv4> address() const;
  /// When to advance() next; not before `at`.
  TimePoint next_wake(TimePoint at) const;
  /// Finishes the pictures and prints the summary.
  ExitStatus sum_up(std::uint64_t kernel_drops);

 private:
  void note_other_head(std::span<const std::uint8_t> datagram);
  std::string advice() const;
  std::string no_ping_text() const;
  void send_commands();
  void take_ping(gemini::ReceivedPing ping);
  void greet_head();
  void show_progress(TimePoint at);
  void refresh_picture();
  void check_limits(TimePoint at);
  void fail(ExitStatus status, const std::string& why);

  const GeminiOptions& options_;
  const std::uint16_t sonar_id_;
  const std::string says_;  ///< prefix of messages: "sonarview: ", with the head's ID if there are several
  boost::asio::ip::udp::socket& commands_;
  gemini::Client client_;
  DatagramDropper drop_rx_, drop_tx_;
  bool send_failed_ = false;

  TimePoint started_{};
  std::optional<TimePoint> head_met_;
  std::map<std::uint16_t, Ipv4> others_;  ///< others that sent a status before the wanted head
  TimePoint last_ping_at_{};
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  PingRateMeter rate_;
  std::optional<gemini::ReceivedPing> last_ping_;  ///< kept only if pictures are wanted
  bool last_ping_shown_ = true;                    ///< its picture is drawn or queued
  GeminiPictures pictures_;
  std::optional<ImageWriter> writer_;
  std::optional<ExitStatus> failure_;
  bool ended_ = false;
};

}  // namespace sonard::client
