// SPDX-License-Identifier: Apache-2.0
// A UDP socket that receives from those who may publish.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include <boost/asio/ip/udp.hpp>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// Belongs to the I/O thread. Shared with the handlers that are queued for it, which find it closed once it
/// is.
class UdpListener : public std::enable_shared_from_this<UdpListener> {
 public:
  /// `bytes` and the peer of this datagram are good for the call, which may close the listener.
  using Handler = std::function<void(std::span<const std::uint8_t> bytes, TimePoint arrival)>;

  /// `name` begins each line of the log: "pose stream udp". `clock` outlives it.
  UdpListener(boost::asio::io_context& io, std::string name, const Endpoint& bind, AllowList allow,
              const Clock& clock);

  /// Binds and listens. Called once.
  /// @throws PoseSourceError
  void start(Handler handler);
  void close();
  bool is_open() const { return socket_.is_open(); }

  /// Where it listens, or will listen.
  const Endpoint& local() const { return local_; }
  /// Who has sent the datagram that is handled, or the last one.
  Endpoint peer() const;
  /// "pose stream udp 127.0.0.1:14600"
  std::string description() const;
  /// Datagrams from peers that are not allowed: each the first, second, fourth, ... time in the log.
  std::uint64_t refused() const { return refused_; }

 private:
  void receive();
  void on_received(std::size_t length);

  std::string name_;
  Endpoint local_;
  AllowList allow_;
  const Clock& clock_;
  boost::asio::ip::udp::socket socket_;
  boost::asio::ip::udp::endpoint peer_;
  Handler handler_;
  std::uint64_t refused_ = 0;
  // One byte more than a message may have, so that a longer datagram shows as such.
  std::array<std::uint8_t, pose::max_message_bytes + 1> buffer_{};
};

}  // namespace sonard::server
