// SPDX-License-Identifier: Apache-2.0
// Assembles one ping at the client. Head, lines and tail come in any order, may repeat or be lost.
// Source: protocol/gemini/README.md 6, 7.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// `count` consecutive lines from `first` on.
struct LineRange {
  int first = 0;
  int count = 0;

  bool operator==(const LineRange&) const = default;
};

/// Samples of a ping, line after line, port to starboard; near lines first. Exactly one vector is filled.
/// Samples of lost lines are zero.
struct ReceivedSamples {
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
};

/// True if a client can make an image of the announced ping: beam magnitudes, at least one line, and sizes
/// that fit the line numbers (15 bits) and datagrams of the protocol.
bool is_receivable(const PingHead& head);

/// Collects the parts of a ping, but requests nothing. Lines that come before the head wait for it, because
/// only the head describes their format.
class PingAssembly {
 public:
  /// Result of adding a line.
  enum class Added {
    fresh,      ///< it was missing
    duplicate,  ///< it had been received already
    unusable    ///< its number or length does not fit the head
  };

  /// @param id low byte of the ping ID, which lines and tail contain too
  explicit PingAssembly(std::uint8_t id) : id_(id) {}

  std::uint8_t id() const { return id_; }
  const std::optional<PingHead>& head() const { return head_; }

  /// Sets the head and decodes the waiting lines. Requires is_receivable(head) and that no head is set yet.
  void set_head(const PingHead& head);
  /// Copies the samples of `line`. Before the head is set, the first line of each number is `fresh`.
  Added add_line(const PingLine& line);

  /// Number of lines that the head announces; 0 before the head.
  int line_count() const { return head_ ? head_->line_count() : 0; }
  /// Decoded lines; 0 before the head.
  int lines_received() const { return lines_received_; }
  /// True if the head and all lines are there. The tail holds no part of the image.
  bool is_complete() const { return head_ && lines_received_ == line_count(); }

  /// The missing lines of [from, to), consecutive ones merged. Requires 0 <= from.
  std::vector<LineRange> missing(int from, int to) const;

  /// Moves the samples out; the assembly cannot be used afterwards. Empty if there is no head.
  ReceivedSamples take_samples() { return std::move(samples_); }

 private:
  bool has_line(int number) const;
  /// Decodes into the image. False if the line does not fit the head.
  bool store(int number, std::span<const std::uint8_t> data);

  std::uint8_t id_;
  std::optional<PingHead> head_;
  ReceivedSamples samples_;
  std::vector<bool> received_;
  int lines_received_ = 0;
  std::map<int, std::vector<std::uint8_t>> waiting_;
};

}  // namespace sonard::gemini
