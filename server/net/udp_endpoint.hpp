// SPDX-License-Identifier: Apache-2.0
// A UDP socket that reports the local address of each datagram and never drops what it sends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "server/net/datagram.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// The OS refused a socket. what() names operation, address and reason.
struct SocketError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// "cannot bind UDP 127.0.0.1:5: Address already in use", where `operation` is "bind UDP 127.0.0.1:5".
/// @throws SocketError; std::system_error where descriptors or memory have run out, which no other address
/// would change
[[noreturn]] void throw_socket_error(const std::string& operation, int error);

/// Counters, which only grow.
struct UdpEndpointCounters {
  std::uint64_t received = 0;
  std::uint64_t truncated = 0;       ///< longer than what is listened for: dropped
  std::uint64_t kernel_dropped = 0;  ///< lost because the receive buffer was full
  std::uint64_t sent = 0;
  std::uint64_t send_failed = 0;  ///< refused by the OS (no route, ...): dropped
  std::uint64_t blocked = 0;      ///< times the socket was full and sending had to wait
  std::uint64_t overflowed = 0;   ///< dropped because most_queued datagrams were waiting
};

/// Belongs to the I/O thread, as every handler of its does. Receives and sends in batches (recvmmsg,
/// sendmmsg). When bound to all addresses, `Datagram::local` of a received one says which address it was sent
/// to (IP_PKTINFO), and `Datagram::local` of one to be sent chooses its source address, and with it the
/// interface a broadcast leaves by.
///
/// Segmentation offload (UDP_SEGMENT) would cost a sixth of the time, but a veth pair hands its large packets
/// on unsplit, and a capture on it would show one packet of many lines: not what a device sends.
///
/// Shutdown: close() cancels the waits; their handlers still run on the io_context, find the socket closed
/// and do nothing. They share ownership of the inner state, so the endpoint may be destroyed before they run.
/// No callback is called after close(), which may be called from within one.
class UdpEndpoint {
 public:
  /// More than three of the largest pings. Reached only when the network takes nothing for seconds.
  static constexpr std::size_t most_queued = 65536;

  using Receive = std::function<void(const Datagram&)>;
  using Sent = std::function<void(std::span<const Datagram>)>;

  /// Whether others may bind the same address and port, as programs that listen to a broadcast do. Not for a
  /// head: two of them on one address must be an error, not a lottery.
  enum class Sharing { alone, with_others };

  /// Longer than any message that a device accepts.
  static constexpr std::size_t most_command_bytes = 2048;

  /// Binds. Port 0 lets the kernel choose. Datagrams of more than `most_bytes` are dropped.
  /// @throws SocketError
  UdpEndpoint(boost::asio::io_context& io, const Endpoint& bind, Sharing sharing = Sharing::alone,
              std::size_t most_bytes = most_command_bytes);
  ~UdpEndpoint();
  UdpEndpoint(const UdpEndpoint&) = delete;
  UdpEndpoint& operator=(const UdpEndpoint&) = delete;

  /// Begins to receive. `drained` is called each time after a full socket has taken all that was waiting,
  /// `sent` with what the kernel has taken, in order.
  void start(Receive receive, std::function<void()> drained = {}, Sent sent = {});
  /// Sends now what the socket takes; the rest follows, in order, as it drains.
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
