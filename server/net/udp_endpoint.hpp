// SPDX-License-Identifier: Apache-2.0
// A UDP socket that reports the local address of each datagram and queues datagrams while it is full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/error/error.hpp"
#include "server/net/datagram.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// The OS refused a socket. what() has operation, address and reason.
struct SocketError : Error {
  explicit SocketError(const std::string& text) : Error(ErrorKind::network, text) {}
};

/// Throws with a text like "cannot bind UDP 127.0.0.1:5: Address already in use" for the operation "bind UDP
/// 127.0.0.1:5".
/// @throws SocketError; std::system_error if descriptors or memory have run out, whatever the address
[[noreturn]] void throw_socket_error(const std::string& operation, int error);

/// Counters; they only grow.
struct UdpEndpointCounters {
  std::uint64_t received = 0;
  std::uint64_t truncated = 0;       ///< longer than the maximum: dropped
  std::uint64_t kernel_dropped = 0;  ///< lost because the receive buffer was full
  std::uint64_t sent = 0;
  std::uint64_t send_failed = 0;  ///< refused by the OS (no route, ...): dropped
  std::uint64_t blocked = 0;      ///< times the socket was full and sending had to wait
  std::uint64_t overflowed = 0;   ///< dropped because most_queued datagrams were waiting
};

/// Belongs to the I/O thread. Receives and sends in batches (recvmmsg, sendmmsg). When bound to all
/// addresses, `Datagram::local` of a received datagram is its destination address (IP_PKTINFO).
/// `Datagram::local` of a sent one sets its source address, and thus the interface of a broadcast.
///
/// Segmentation offload (UDP_SEGMENT) would take a sixth of the time. But a veth pair passes on its large
/// packets unsplit, so a capture would show one packet of many lines, unlike a real device.
///
/// Shutdown: close() cancels the waits. Their handlers still run on the io_context, find the socket closed
/// and do nothing. They share ownership of the inner state, so the endpoint may be destroyed before they run.
/// No callback is called after close(), which may be called from within a callback.
class UdpEndpoint {
 public:
  /// More than three of the largest pings. Reached only if the network takes nothing for seconds.
  static constexpr std::size_t most_queued = 65536;

  using Receive = std::function<void(const Datagram&)>;
  using Sent = std::function<void(std::span<const Datagram>)>;

  /// Whether other programs may bind the same address and port, as for listening to a broadcast. Not for
  /// heads: two heads on one address must be an error.
  enum class Sharing { alone, with_others };

  /// Longer than any message that a device accepts.
  static constexpr std::size_t most_command_bytes = 2048;

  /// Binds. Port 0 lets the kernel choose. Longer datagrams than `most_bytes` are dropped.
  /// @throws SocketError
  UdpEndpoint(boost::asio::io_context& io, const Endpoint& bind, Sharing sharing = Sharing::alone,
              std::size_t most_bytes = most_command_bytes);
  ~UdpEndpoint();
  UdpEndpoint(const UdpEndpoint&) = delete;
  UdpEndpoint& operator=(const UdpEndpoint&) = delete;

  /// Starts to receive. `drained` is called each time that a full socket has taken all queued datagrams,
  /// `sent` with the datagrams that the kernel has taken, in order.
  void start(Receive receive, std::function<void()> drained = {}, Sent sent = {});
  /// Multicast leaves by the interface with the address that the socket is bound to.
  /// @param ttl routers that it may pass, plus 1. @throws SocketError
  void set_multicast_ttl(int ttl);
  /// Sends at once as many as the socket takes; queues the rest, in order.
  void send(std::vector<Datagram> datagrams);
  /// True while datagrams wait for the socket.
  bool blocked() const;
  void close();

  Endpoint local_endpoint() const;
  const UdpEndpointCounters& counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
