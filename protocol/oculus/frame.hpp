// SPDX-License-Identifier: Apache-2.0
// Finds the messages of a client in a stream of bytes. Source: protocol/oculus/README.md 3.1.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// Maximum payload that a client may announce in a header; a larger value is not from a client of a head.
inline constexpr std::size_t most_command_payload = 4096;

/// Reads the header of a message of at least header_size bytes.
Header read_header(std::span<const std::uint8_t> message);

/// Payload size of a command: the stated size, or the known size of its message if the header states 0.
std::size_t command_payload_size(const Header& header);

/// Collects the bytes of one client, in parts of any size, into commands. Not thread-safe.
class CommandBuffer {
 public:
  void append(std::span<const std::uint8_t> bytes);
  /// The command in front with its header, after dropping bytes before it; valid until the next call. It
  /// stays in front until pop().
  std::optional<std::span<const std::uint8_t>> front();
  void pop();
  /// Drops all bytes, because the next bytes are from another connection.
  void clear();

  /// True after a command longer than most_command_payload; then close the connection.
  bool broken() const { return broken_; }
  /// Bytes outside commands, since construction.
  std::uint64_t dropped() const { return dropped_; }

 private:
  std::span<const std::uint8_t> rest() const { return std::span{bytes_}.subspan(begin_); }
  void drop_to_start();

  std::vector<std::uint8_t> bytes_;
  std::size_t begin_ = 0;       ///< bytes before it have been consumed
  std::size_t front_size_ = 0;  ///< of the command that front() returned
  bool broken_ = false;
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::oculus
