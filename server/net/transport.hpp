// SPDX-License-Identifier: Apache-2.0
// The interface between a head and its clients: sockets or a serial line.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "server/net/wire.hpp"

namespace sonard::server {

/// Callbacks of a transport to its head. All are called on the I/O thread, and not after stop().
struct TransportEvents {
  std::function<void(BytesReceived)> received;
  std::function<void(ClientCame)> came;  ///< may be empty for transports without connections
  std::function<void(ClientGone)> gone;
  std::function<void()> writable;  ///< blocked() is false again
  std::function<void(Notice)> notice;

  // For a recording; may be empty.
  std::function<void(WirePassed)> passed;      ///< called for all bytes that pass the sockets
  std::function<void(const WireEnds&)> ended;  ///< a stream has ended
};

/// Belongs to the I/O thread. The thread that owns the io_context constructs and destroys it while the
/// context does not run. Constructors open the sockets and throw SocketError. Never blocks.
class Transport {
 public:
  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Starts to read from clients.
  virtual void start(TransportEvents events) = 0;
  virtual void stop() = 0;
  virtual void send(std::vector<Outgoing> messages) = 0;
  /// Closes the connection of a client, if the transport has connections.
  virtual void disconnect(const Peer& /*client*/) {}
  /// True while data waits for the OS: further messages would pile up.
  virtual bool blocked() const { return false; }

  /// One per port for clients, for the log: "tcp 127.0.0.1:4001".
  virtual std::vector<std::string> descriptions() const = 0;
  /// Configured faults of the link, for people: "to clients: 5 % lost"; empty: there are no faults.
  virtual std::string faults() const { return ""; }
  virtual std::vector<Counter> counts() const = 0;
};

}  // namespace sonard::server
