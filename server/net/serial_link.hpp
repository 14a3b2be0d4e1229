// SPDX-License-Identifier: Apache-2.0
// The serial line of a device, with every way by which clients reach it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/net/serial_port.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// Counters, which only grow.
struct SerialLinkCounters {
  SerialPortCounters ports;             ///< of all ports together
  std::vector<SerialPortReport> each;   ///< in the order of the configuration
  std::uint64_t frames_unheard = 0;     ///< discarded: no client was connected
  std::uint64_t frames_overflowed = 0;  ///< dropped: SerialLink::most_waiting_bytes were waiting for the line
  std::uint64_t bytes_overrun = 0;      ///< from clients, dropped for the same reason
  std::uint64_t locked_out = 0;         ///< reads of clients that were dropped: another had the line
};

/// Where clients reach a link. In the order of its configuration, with the ports that the kernel chose.
struct SerialAddresses {
  std::vector<Endpoint> tcp;
  std::vector<Endpoint> udp;
  std::vector<std::string> pty;  ///< paths of the slaves
};

/// All clients share one line, as on RS485: each receives every frame, and what they send comes in the order
/// in which it was read. A client that is not there when a frame is sent never gets it.
///
/// With a line speed (SerialLinkConfig::baud) bytes take their time in both directions, see LinePacer, and
/// still arrive in one piece: a frame of n bytes n * 10 / baud seconds after send() at the earliest, a read
/// of n bytes as much after it came. The speed delays a client that asks and waits, by 1.2 ms for a command
/// of 14 bytes and 38.6 ms for a reply of 445 bytes at 115200 baud, and it bounds the rate. Without it
/// nothing is added.
///
/// With SerialLinkConfig::lock_to_first the first address that sends has the line, until it is silent for
/// lock_timeout: what others send is dropped, and they still receive every frame of the line. All pseudo
/// terminals are one address.
///
/// Nothing here blocks or grows: a client that reads too slowly loses whole frames (SerialPort::send()), and
/// what a line cannot carry in time is dropped and counted.
///
/// Belongs to the I/O thread, as all its handlers do; constructor and destructor to the thread that
/// owns the io_context while it does not run. After stop() no callback is called; it, and the destructor, may
/// be called from within one. Handlers that are still queued find the inner state stopped or gone.
class SerialLink {
 public:
  /// Waiting for the line in one direction: five of the longest frames, 0.7 s at 115200 baud.
  static constexpr std::size_t most_waiting_bytes = 8192;
  static constexpr std::chrono::seconds lock_timeout{10};

  /// One read of one client: any piece of a command, or several. `peer` tells clients apart.
  using Receive = std::function<void(std::span<const std::uint8_t> bytes, const std::string& peer)>;
  /// A client has left, after all that it sent: the rest of a command that it had begun will not come.
  using Left = std::function<void(const std::string& peer)>;

  /// Opens everything; it reads from clients from start() on.
  /// @throws SocketError naming the address or path
  SerialLink(boost::asio::io_context& io, const SerialLinkConfig& config, const Clock& clock);
  ~SerialLink();
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  /// @param passed, ended as SerialPortEvents has them, of all ports; may be empty
  void start(Receive receive, Left left, decltype(SerialPortEvents::passed) passed = {},
             decltype(SerialPortEvents::ended) ended = {});
  void stop();
  /// Sends a whole frame to all connected clients.
  void send(std::vector<std::uint8_t> frame);
  bool connected() const;

  SerialAddresses addresses() const;
  /// One for each port, for the log: "tcp 127.0.0.1:4001", "pty /dev/pts/3 linked to by /tmp/sonar".
  std::vector<std::string> descriptions() const;
  SerialLinkCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
