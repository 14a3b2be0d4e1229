// SPDX-License-Identifier: Apache-2.0
// The interface between a head and its clients: sockets or a serial line.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "server/net/wire.hpp"

namespace sonard::server {

/// Callbacks of a transport to its head. All are called on the I/O thread, none after stop().
struct TransportEvents {
  std::function<void(BytesReceived)> received;
  std::function<void(ClientCame)> came;  ///< may be empty, of transports that have no connections
  std::function<void(ClientGone)> gone;
  std::function<void()> writable;  ///< blocked() is false again
  std::function<void(Notice)> notice;

  // For a recording; may be empty.
  std::function<void(WirePassed)> passed;      ///< called for all that passes the sockets
  std::function<void(const WireEnds&)> ended;  ///< a stream is over
};

/// Belongs to the I/O thread, as all its handlers do; constructor and destructor to the thread that
/// owns the io_context while it does not run. The constructors open what they serve and throw SocketError.
/// Nothing here waits.
class Transport {
 public:
  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// Begins to read from clients.
  virtual void start(TransportEvents events) = 0;
  virtual void stop() = 0;
  virtual void send(std::vector<Outgoing> messages) = 0;
  /// Closes the connection of a client behind what was sent to it, where there are connections.
  virtual void disconnect(const Peer& /*client*/) {}
  /// True while something to send waits for the OS: a head that continues to send would pile it up.
  virtual bool blocked() const { return false; }

  /// One for each way by which clients come, for the log: "tcp 127.0.0.1:4001".
  virtual std::vector<std::string> descriptions() const = 0;
  /// The faults that are put on what passes, for people: "to clients: 5 % lost"; empty: there are none.
  virtual std::string faults() const { return ""; }
  virtual std::vector<Counter> counts() const = 0;
};

}  // namespace sonard::server
