// SPDX-License-Identifier: Apache-2.0
// The other end of a serial line, by plain system calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/net/addresses.hpp"

namespace sonard::test {

using Bytes = std::vector<std::uint8_t>;

/// Owns a non-blocking descriptor and closes it. Movable.
class Client {
 public:
  /// Connects, or throws.
  /// @param receive_buffer_bytes 0: the system's default
  static Client tcp(const Endpoint& to, Ipv4 from = 0x7F000001, int receive_buffer_bytes = 0);
  static Client udp(const Endpoint& to, Ipv4 from = 0x7F000001);
  static Client tty(const std::string& path);

  explicit Client(int fd) : fd_(fd) {}
  Client(Client&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Client& operator=(Client&&) = delete;
  ~Client() { close(); }

  /// Returns false if the system did not take all bytes.
  bool try_write(std::span<const std::uint8_t> bytes) const;
  /// Writes all bytes, or fails the test.
  void write(std::span<const std::uint8_t> bytes) const;
  /// Bytes of one read() of up to 4096 bytes; empty if there are no bytes or the other end has closed.
  Bytes read_once() const;
  /// Reads the available bytes and returns all bytes read so far by this function.
  const Bytes& heard();
  /// True if the other end has closed the connection and all bytes are read.
  bool closed_by_peer();
  /// Number of bytes that can be read.
  std::size_t readable() const;
  /// The local address.
  Endpoint endpoint() const;
  void close();
  /// Closes a TCP connection with a reset.
  void reset();
  int fd() const { return fd_; }

 private:
  int fd_;
  Bytes heard_;
};

}  // namespace sonard::test
