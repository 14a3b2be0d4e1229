// SPDX-License-Identifier: Apache-2.0
// One way of reaching a serial device: a TCP listener, a UDP socket or a pseudo terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "server/net/addresses.hpp"
#include "server/net/wire.hpp"

namespace sonard::server {

/// A TCP listener that gives each client the raw bytes of a serial line, like serial device servers.
struct SerialTcpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A UDP socket that carries a serial line: one datagram per write of either side.
struct SerialUdpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A pseudo terminal; its slave is a serial device to clients.
struct SerialPtyConfig {
  /// Symbolic link to the slave, whose own name changes at each start; empty: no link.
  std::filesystem::path link;
};

/// All ports of a serial device; clients can use them at the same time.
struct SerialLinkConfig {
  std::vector<SerialTcpConfig> tcp;
  std::vector<SerialUdpConfig> udp;
  std::vector<SerialPtyConfig> pty;
  int baud = 0;                ///< bits per second of the line, ten per byte; 0: no delay
  bool lock_to_first = false;  ///< see SerialLink
};

/// "TCP 127.0.0.1:4001, a pty at /tmp/sonar"
std::string serial_text(const SerialLinkConfig& config);

/// Maximum bytes per read from a client; longer than any command of a device.
inline constexpr std::size_t serial_read_bytes = 2048;

/// Counters; they only grow.
struct SerialPortCounters {
  std::uint64_t connections = 0;     ///< number of connected clients so far
  std::uint64_t refused = 0;         ///< refused connections or datagrams: not allowed, too many, too long
  std::uint64_t bytes_in = 0;        ///< from all clients
  std::uint64_t bytes_out = 0;       ///< to all clients: a frame to two clients counts twice
  std::uint64_t frames_dropped = 0;  ///< a client had not read earlier frames
  std::uint64_t frames_lost = 0;     ///< the other end was gone, or the OS refused
};

/// The report of one port, for the log.
struct SerialPortReport {
  std::string description;  ///< SerialPort::description()
  SerialPortCounters counters;
};

/// Events of a port. `peer` identifies a client while it is connected, "tcp 127.0.0.1:50312".
struct SerialPortEvents {
  /// True if bytes from this address are accepted now (0: from a pseudo terminal); else they are dropped.
  std::function<bool(Ipv4 address)> takes;
  std::function<void(std::span<const std::uint8_t> bytes, const std::string& peer)> received;
  /// The client is gone; the rest of a partial message will not come.
  std::function<void(const std::string& peer)> left;
  /// Optional. Called when bytes pass the socket or terminal, before they are queued. For a frame that a
  /// client takes in two parts, called once, with the first part.
  std::function<void(const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes)> passed;
  /// Optional. The stream of that client has ended.
  std::function<void(const WireEnds& ends)> ended;
};

/// Belongs to the I/O thread. Constructors open the port and throw SocketError. After start() the port reads
/// from clients. After stop() no event is called; stop() may be called from within an event.
class SerialPort {
 public:
  SerialPort() = default;
  virtual ~SerialPort() = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  virtual void start(SerialPortEvents events) = 0;
  virtual void stop() = 0;
  /// Sends the frame to every client, with one system call each and no retry. A client whose buffers are full
  /// does not get it. If the buffers take only a part, the rest follows as they drain, and frames until then
  /// are dropped. So clients read only whole frames.
  virtual void send(std::span<const std::uint8_t> frame) = 0;
  virtual bool connected() const = 0;
  /// For the log: "tcp 127.0.0.1:4001".
  virtual std::string description() const = 0;
  virtual SerialPortCounters counters() const = 0;
};

}  // namespace sonard::server
