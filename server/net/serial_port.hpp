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

/// A TCP listener that gives a serial line's raw bytes to each client, as serial device servers do.
struct SerialTcpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A UDP socket that carries a serial line: a datagram for each write of either side.
struct SerialUdpConfig {
  Endpoint bind;
  AllowList allow;
};

/// A pseudo terminal, whose slave is a serial device to clients.
struct SerialPtyConfig {
  /// Symbolic link to the slave, whose own name is new at each start; empty: none.
  std::filesystem::path link;
};

/// All ways by which clients reach a serial device at once.
struct SerialLinkConfig {
  std::vector<SerialTcpConfig> tcp;
  std::vector<SerialUdpConfig> udp;
  std::vector<SerialPtyConfig> pty;
  int baud = 0;  ///< bits per second of the line, ten to a byte; 0: bytes pass as fast as they go
  bool lock_to_first = false;  ///< see SerialLink
};

/// "TCP 127.0.0.1:4001, a pty at /tmp/sonar"
std::string serial_text(const SerialLinkConfig& config);

/// Most bytes taken from a client with one system call; longer than any command of a device.
inline constexpr std::size_t serial_read_bytes = 2048;

/// Counters, which only grow.
struct SerialPortCounters {
  std::uint64_t connections = 0;  ///< clients that came
  std::uint64_t refused = 0;      ///< connections, or datagrams, turned away: not allowed, too many, too long
  std::uint64_t bytes_in = 0;     ///< of all clients
  std::uint64_t bytes_out = 0;    ///< to all clients: a frame that two of them get counts twice
  std::uint64_t frames_dropped = 0;  ///< a client had not read earlier frames
  std::uint64_t frames_lost = 0;     ///< the other end was gone, or the OS refused
};

/// The report of one port, for the log.
struct SerialPortReport {
  std::string description;  ///< SerialPort::description()
  SerialPortCounters counters;
};

/// Events of a port. `peer` names one as long as it is there, "tcp 127.0.0.1:50312".
struct SerialPortEvents {
  /// Whether bytes from this address are taken now (0: of a pseudo terminal). What is not is dropped.
  std::function<bool(Ipv4 address)> takes;
  std::function<void(std::span<const std::uint8_t> bytes, const std::string& peer)> received;
  /// The client is gone; the rest of a message that it had begun will not come.
  std::function<void(const std::string& peer)> left;
  /// Optional. Bytes have passed the socket or terminal, before they wait for anything here; a frame that a
  /// client takes in two parts is told once, with the first.
  std::function<void(const WireEnds& ends, bool to_client, std::span<const std::uint8_t> bytes)> passed;
  /// Optional. The stream of that client is over.
  std::function<void(const WireEnds& ends)> ended;
};

/// Belongs to the I/O thread, as all its handlers do. The constructors open what they serve and throw
/// SocketError; from start() on it reads from clients. After stop() no event is called; it may be called from
/// within one.
class SerialPort {
 public:
  SerialPort() = default;
  virtual ~SerialPort() = default;
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  virtual void start(SerialPortEvents events) = 0;
  virtual void stop() = 0;
  /// Sends the frame to every client with one system call each, without a later try. A client whose buffers
  /// are full does not get it. Where the buffers took only the first part the rest follows as they drain, and
  /// frames until then are dropped: what a client reads is whole frames.
  virtual void send(std::span<const std::uint8_t> frame) = 0;
  virtual bool connected() const = 0;
  /// For the log: "tcp 127.0.0.1:4001".
  virtual std::string description() const = 0;
  virtual SerialPortCounters counters() const = 0;
};

}  // namespace sonard::server
