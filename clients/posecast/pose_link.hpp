// SPDX-License-Identifier: Apache-2.0
// The connection for poses to sonard: one message per UDP datagram, or a TCP stream of delimited messages.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "protocol/pose/pose_codec.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::client {

/// A network error. what() is one line with address, operation and reason.
struct LinkError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct LinkCounters {
  std::uint64_t sent = 0;
  std::uint64_t refused = 0;  ///< UDP: datagrams refused because nothing listened there; TCP: 0
  std::uint64_t skipped = 0;  ///< TCP: dropped because the previous pose was still being sent
};

/// A connection to one receiver. Everything runs on the thread of the io_context.
class PoseLink {
 public:
  virtual ~PoseLink() = default;
  /// Sends one pose. If it would have to wait, drops and counts it, because an old pose is useless.
  virtual void send(const pose::PoseSample& sample) = 0;
  /// Calls `done` when the last pose of send() has left.
  virtual void when_sent(std::function<void()> done) = 0;
  /// Calls `done` when the receiver has read all poses (TCP), or at once (UDP). Do not call send()
  /// afterwards.
  virtual void finish(std::function<void()> done) = 0;
  /// The address, "udp 127.0.0.1:14600".
  virtual const std::string& description() const = 0;
  virtual const LinkCounters& counters() const = 0;
};

struct Destination {
  std::string host;
  std::string port;
  bool tcp = false;
};

/// Parses "HOST:PORT" with parse_host_and_port().
std::optional<Destination> parse_destination(const std::string& text, bool tcp);

/// Resolves the host and connects (IPv4). `on_failure` is called once, from the io_context, if the receiver
/// closes the link or the network fails. A UDP receiver that does not listen yet is not a failure.
/// @throws LinkError
std::unique_ptr<PoseLink> connect(boost::asio::io_context& io, const Destination& destination,
                                  std::function<void(const std::string& what)> on_failure);

}  // namespace sonard::client
