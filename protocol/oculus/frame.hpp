// SPDX-License-Identifier: Apache-2.0
// Where a message of a host begins and ends in a stream of bytes. Source: docs/protocols/oculus.md 3.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// Bytes behind the header that a host may announce; what announces more is no client of a head.
inline constexpr std::size_t most_command_payload = 4096;

/// The header of a message of at least header_size bytes.
Header read_header(std::span<const std::uint8_t> message);

/// Bytes behind the header of a command: what it states, or what hosts send that state 0.
std::size_t command_payload_size(const Header& header);

/// Gathers the bytes of one client, in parts of any size, into commands. Not thread-safe.
class CommandBuffer {
 public:
  void append(std::span<const std::uint8_t> bytes);
  /// The command in front with its header, after dropping bytes that begin none; valid until the next call.
  /// Stays until pop().
  std::optional<std::span<const std::uint8_t>> front();
  void pop();
  /// What has begun will not be finished. The next bytes are those of another connection.
  void clear();

  /// True from the first command on that is longer than most_command_payload: the connection is to be closed.
  bool broken() const { return broken_; }
  /// Bytes that were part of no command, since construction.
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop_to_start();

  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it are done with
  std::size_t front_size_ = 0;  ///< of the command that front() gave
  bool broken_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::oculus
