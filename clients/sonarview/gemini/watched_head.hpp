// SPDX-License-Identifier: Apache-2.0
// One of the heads that sonarview talks to: its topside, its pictures, and what is said of it.
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
#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/ping_log.hpp"
#include "clients/sonarview/gemini/ping_pictures.hpp"
#include "protocol/gemini/topside.hpp"

namespace sonard::client {

/// Everything on the thread of its caller but the writing of pictures.
class WatchedHead {
 public:
  /// @param number its place in GeminiOptions::sonar_ids
  /// @param commands the socket that commands leave from; outlives this
  /// @throws std::runtime_error (folder for pictures)
  WatchedHead(const GeminiOptions& options, std::size_t number, boost::asio::ip::udp::socket& commands);

  void start(TimePoint at);
  /// A datagram of any head has come.
  void on_datagram(TimePoint at, std::span<const std::uint8_t> datagram);
  /// Does what is due, and ends when a limit is reached.
  void advance(TimePoint at);
  /// Says goodbye to the head.
  void end();
  bool ended() const { return ended_; }
  /// Where the head is; nullopt before its first status.
  std::optional<Ipv4> address() const;
  /// When to advance() next; not before `at`.
  TimePoint next_wake(TimePoint at) const;
  /// Finishes the pictures and prints the summary.
  ExitStatus sum_up(std::uint64_t kernel_drops);

 private:
  void note_other_head(std::span<const std::uint8_t> datagram);
  std::string advice() const;
  void send_commands();
  void take_ping(gemini::ReceivedPing ping);
  void greet_head();
  void show_progress(TimePoint at);
  void refresh_picture();
  void check_limits(TimePoint at);
  void fail(ExitStatus status, const std::string& why);

  const GeminiOptions& options_;
  const std::uint16_t sonar_id_;
  const std::string says_;  ///< "sonarview: ", with the head where there are several
  boost::asio::ip::udp::socket& commands_;
  gemini::Topside topside_;
  DatagramDropper drop_rx_, drop_tx_;
  bool send_failed_ = false;

  TimePoint started_{};
  std::optional<TimePoint> head_met_;
  std::map<std::uint16_t, Ipv4> others_;  ///< heads that sent a status meanwhile, with their addresses
  TimePoint last_ping_at_{};
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  PingRate rate_;
  std::optional<gemini::ReceivedPing> last_ping_;  ///< only while its picture may be wanted
  bool last_ping_shown_ = true;                    ///< its picture is there, or on its way
  PingPictures pictures_;
  std::optional<ImageWriter> writer_;
  std::optional<ExitStatus> failure_;
  bool ended_ = false;
};

}  // namespace sonard::client
