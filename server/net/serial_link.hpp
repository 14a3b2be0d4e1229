// SPDX-License-Identifier: Apache-2.0
// The serial line of a device, with all ports through which clients reach it.
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

/// Counters; they only grow.
struct SerialLinkCounters {
  SerialPortCounters ports;             ///< sum over all ports
  std::vector<SerialPortReport> each;   ///< in the order of the configuration
  std::uint64_t frames_unheard = 0;     ///< dropped: no client was connected
  std::uint64_t frames_overflowed = 0;  ///< dropped: most_waiting_bytes were waiting for the line
  std::uint64_t bytes_overrun = 0;      ///< from clients, dropped for the same reason
  std::uint64_t locked_out = 0;         ///< dropped reads of clients, while another had the line
};

/// Addresses of a link, in the order of its configuration, with the ports that the kernel chose.
struct SerialAddresses {
  std::vector<Endpoint> tcp;
  std::vector<Endpoint> udp;
  std::vector<std::string> pty;  ///< paths of the slaves
};

/// All clients share one line, as on RS485: each receives every frame, and the device receives their bytes in
/// the order of reading. A client that is not connected when a frame is sent never gets it.
///
/// With a line speed (SerialLinkConfig::baud), bytes take time in both directions (LinePacer), but arrive in
/// one piece. A frame of n bytes arrives n * 10 / baud seconds after send() at the earliest, a read of n
/// bytes as long after it came. At 115200 baud, a command of 14 bytes takes 1.2 ms and a reply of 445 bytes
/// 38.6 ms. The speed also limits the rate. Without it there is no delay.
///
/// With SerialLinkConfig::lock_to_first, the first address that sends holds the line until it is silent for
/// lock_timeout. Bytes of other addresses are dropped, but they still receive every frame. All pseudo
/// terminals count as one address.
///
/// Nothing here blocks or grows without limit. A client that reads too slowly loses whole frames
/// (SerialPort::send()). Data that a line cannot carry in time is dropped and counted.
///
/// Belongs to the I/O thread. The thread that owns the io_context constructs and destroys it while the
/// context does not run. After stop() no callback is called. stop() and the destructor may be called from
/// within a callback. Queued handlers find the inner state stopped or gone.
class SerialLink {
 public:
  /// Limit of the bytes waiting in one direction: five of the longest frames, 0.7 s at 115200 baud.
  static constexpr std::size_t most_waiting_bytes = 8192;
  static constexpr std::chrono::seconds lock_timeout{10};

  /// One read from one client: a part of a command, or several commands. `peer` identifies the client.
  using Receive = std::function<void(std::span<const std::uint8_t> bytes, const std::string& peer)>;
  /// A client has left, after all its bytes; the rest of a partial command will not come.
  using Left = std::function<void(const std::string& peer)>;

  /// Opens all ports; reads from clients after start().
  /// @throws SocketError naming the address or path
  SerialLink(boost::asio::io_context& io, const SerialLinkConfig& config, const Clock& clock);
  ~SerialLink();
  SerialLink(const SerialLink&) = delete;
  SerialLink& operator=(const SerialLink&) = delete;

  /// @param passed, ended as in SerialPortEvents, for all ports; may be empty
  void start(Receive receive, Left left, decltype(SerialPortEvents::passed) passed = {},
             decltype(SerialPortEvents::ended) ended = {});
  void stop();
  /// Sends a whole frame to all connected clients.
  void send(std::vector<std::uint8_t> frame);
  bool connected() const;

  SerialAddresses addresses() const;
  /// One per port, for the log: "tcp 127.0.0.1:4001", "pty /dev/pts/3 linked to by /tmp/sonar".
  std::vector<std::string> descriptions() const;
  SerialLinkCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;
};

}  // namespace sonard::server
