// SPDX-License-Identifier: Apache-2.0
// Sends pings, poses and the status to Foxglove and compatible viewers, by the protocol of
// github.com/foxglove/ws-protocol, docs/spec.md, with messages in JSON.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/steady_timer.hpp>

#include "server/web/web_socket.hpp"

namespace sonard::server {

/// Channels of each head: "/NAME/image" (foxglove.CompressedImage, PNG) and "/NAME/transform"
/// (foxglove.FrameTransform, "world" to NAME). One channel for all: "/status". A channel without a subscriber
/// costs nothing. A subscriber that reads too slowly misses messages.
class FoxgloveSession final : public WebSocket {
 public:
  /// Names of the protocol: those of ws-protocol and of its successor, Foxglove's SDK. The messages are the
  /// same (github.com/orgs/foxglove/discussions/1131).
  static constexpr std::array<std::string_view, 2> protocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};

  FoxgloveSession(Site& site, boost::beast::tcp_stream stream, const Endpoint& peer);

  void show(const std::shared_ptr<const ShownPing>& ping) override;
  void show_picture(int head, const Text& picture) override;
  void close() override;

 private:
  enum class Kind : std::uint8_t { image, transform, echoes, status };
  struct Channel {
    std::size_t head = 0;  ///< index in the configuration; 0 for the status
    Kind kind = Kind::status;

    auto operator<=>(const Channel&) const = default;
  };

  void opened() override;
  void take(const std::string& text) override;
  void advertise(const DaemonStatus& status);
  void every_second();
  void show_last(std::size_t head);
  void send_on(const Channel& channel, Text json_text);
  void complain(const std::string& what);

  std::map<std::uint32_t, Channel> channels_;       ///< by id
  std::map<Channel, std::uint32_t> subscriptions_;  ///< with the IDs that the other side chose
  std::vector<std::string> heads_;                  ///< names of the heads
  std::map<std::size_t, Text> shown_;               ///< the last picture shown, by head
  boost::asio::steady_timer timer_;
};

}  // namespace sonard::server
