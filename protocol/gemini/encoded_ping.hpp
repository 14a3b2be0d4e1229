// SPDX-License-Identifier: Apache-2.0
// A whole ping as encoded datagrams (protocol/gemini/README.md 6, 7.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/common/shared_bytes.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// True if the image holds exactly the samples that the job requests.
bool fits(const PingImage& image, const PingJob& job);

/// Head, lines and tail, encoded once into a buffer that all datagrams of the ping share.
class EncodedPing {
 public:
  /// Requires a complete `head` and an image of head.line_count() lines of beam_count samples, of the width
  /// that head.ext_mode states. `line_scale` is PingLine::scale.
  EncodedPing(const PingHead& head, std::uint16_t line_scale, const PingImage& image);

  const PingHead& head() const { return head_; }
  int line_count() const { return head_.line_count(); }
  /// Head, lines and tail: line_count() + 2.
  int datagram_count() const { return line_count() + 2; }
  /// Datagram `index` in the order of sending: 0 is the head, 1.. the lines, the last one the tail.
  SharedBytes datagram(int index) const;

  /// Head, line and tail marked as repetitions: bit 8 of the ping ID, bit 15 of the line number, bit 7 of the
  /// tail flags.
  SharedBytes resent_head() const;
  SharedBytes resent_line(int number) const;
  SharedBytes resent_tail() const;

 private:
  PingLine make_line(int number, std::span<const std::uint8_t> data) const;
  PingTail make_tail() const;

  PingHead head_;
  std::uint16_t line_scale_;
  std::shared_ptr<const std::vector<std::uint8_t>> bytes_;
  std::vector<std::uint32_t> offsets_;  ///< start of each datagram, and the end of the last
};

}  // namespace sonard::gemini
