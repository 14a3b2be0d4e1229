// SPDX-License-Identifier: Apache-2.0
// The other end of a serial line, with nothing between it and the system calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/config/config.hpp"

namespace sonard::test {

using Bytes = std::vector<std::uint8_t>;

/// A descriptor that never blocks. Moves, and closes what it owns.
class Client {
 public:
  /// Connected, or an exception.
  /// @param receive_buffer_bytes 0: as the kernel likes
  static Client tcp(const Endpoint& to, Ipv4 from = 0x7F000001, int receive_buffer_bytes = 0);
  static Client udp(const Endpoint& to, Ipv4 from = 0x7F000001);
  static Client tty(const std::string& path);

  explicit Client(int fd) : fd_(fd) {}
  Client(Client&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Client& operator=(Client&&) = delete;
  ~Client() { close(); }

  /// False when not all of it was taken.
  bool try_write(std::span<const std::uint8_t> bytes) const;
  /// All of it, or a failure of the test.
  void write(std::span<const std::uint8_t> bytes) const;
  /// What one read() of up to 4096 bytes finds; empty when there is nothing, or nothing any more.
  Bytes read_once() const;
  /// What can be read now, added to what was read before.
  const Bytes& heard();
  /// True once the other end has closed the connection and all is read.
  bool closed_by_peer();
  /// Bytes that wait to be read.
  std::size_t readable() const;
  /// Our own address.
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
