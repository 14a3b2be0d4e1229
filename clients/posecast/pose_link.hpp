// SPDX-License-Identifier: Apache-2.0
// The way of poses to sonard: one message per UDP datagram, or a TCP stream of delimited messages.
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

/// The network refused. what() is one line naming address, operation and reason.
struct LinkError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct LinkCounters {
  std::uint64_t sent = 0;
  std::uint64_t refused = 0;  ///< UDP: sent, but refused as no one listened there; TCP: none
  std::uint64_t skipped = 0;  ///< TCP: the receiver had not taken the one before yet
};

/// One destination. Everything happens on the thread that runs the io_context.
class PoseLink {
 public:
  virtual ~PoseLink() = default;
  /// Sends one pose, or gives it up and counts it: a pose that waits is worth nothing.
  virtual void send(const pose::PoseSample& sample) = 0;
  /// Calls `done` when what send() took is on its way.
  virtual void when_sent(std::function<void()> done) = 0;
  /// Calls `done` when the receiver has taken all, as far as the transport tells; nothing may be sent after
  /// this.
  virtual void finish(std::function<void()> done) = 0;
  /// "udp 127.0.0.1:14600"
  virtual const std::string& description() const = 0;
  virtual const LinkCounters& counters() const = 0;
};

struct Destination {
  std::string host;
  std::string port;
  bool tcp = false;
};

/// "HOST:PORT", as parse_host_and_port() has it.
std::optional<Destination> parse_destination(const std::string& text, bool tcp);

/// Resolves the host and connects (IPv4). `on_failure` is called once, from the io_context, when the link is
/// lost for good: the receiver closed it, or the network is gone. That a UDP receiver is not there yet is no
/// failure.
/// @throws LinkError
std::unique_ptr<PoseLink> connect(boost::asio::io_context& io, const Destination& destination,
                                  std::function<void(const std::string& what)> on_failure);

}  // namespace sonard::client
