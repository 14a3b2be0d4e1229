// SPDX-License-Identifier: Apache-2.0
// One ping as it comes together at the topside: head, lines and tail in any order, some twice, some never.
// Source: docs/protocols/gemini.md 6, 7.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Neighbouring lines, `first` and `count` - 1 after it.
struct LineRange {
  int first = 0;
  int count = 0;

  bool operator==(const LineRange&) const = default;
};

/// Samples of a ping, line after line, port to starboard; near lines first. Exactly one vector is filled.
/// Samples of lines that never came are zero.
struct PingSamples {
  std::vector<std::uint8_t> u8;
  std::vector<std::uint16_t> u16;
};

/// Whether a topside can make an image of what this head announces: beam magnitudes, at least one line, and
/// sizes that fit the line numbers (15 bits) and datagrams of the protocol.
bool is_receivable(const PingHead& head);

/// Collects what arrives; asks for nothing itself. Lines that come before the head wait for it, because only
/// the head says how to read them.
class PingAssembly {
 public:
  /// What became of a line.
  enum class Added {
    fresh,      ///< it was missing
    duplicate,  ///< it was there already
    unusable    ///< its number or length does not fit the head, or it is shorter than it says
  };

  /// `id`: low byte of the ping ID, which lines and tail carry too.
  explicit PingAssembly(std::uint8_t id) : id_(id) {}

  std::uint8_t id() const { return id_; }
  const std::optional<PingHead>& head() const { return head_; }

  /// Requires is_receivable(head) and that no head is set yet. Reads the lines that waited for it.
  void set_head(const PingHead& head);
  /// Copies out of `line`. Before the head the answer is `fresh` for each line number seen first.
  Added add_line(const PingLine& line);

  /// Lines announced by the head; 0 before it.
  int line_count() const { return head_ ? head_->line_count() : 0; }
  int lines_received() const { return lines_received_; }
  bool has_line(int number) const;
  /// Head and every line are there. The tail carries nothing of the image.
  bool is_complete() const { return head_ && lines_received_ == line_count(); }

  /// The lines of [from, to) that are missing, neighbours merged. Requires 0 <= from.
  std::vector<LineRange> missing(int from, int to) const;

  /// Moves the samples out; the assembly is spent. Without a head there are none.
  PingSamples take_samples();

 private:
  struct Waiting {
    int number = 0;
    std::vector<std::uint8_t> data;
  };

  /// Decodes into the image; false when `data` holds fewer samples than the head announces beams.
  bool store(int number, std::span<const std::uint8_t> data);
  void mark(int number);

  std::uint8_t id_;
  std::optional<PingHead> head_;
  PingSamples samples_;
  std::vector<bool> received_;
  int lines_received_ = 0;
  std::vector<Waiting> waiting_;
};

}  // namespace sonard::gemini
