// SPDX-License-Identifier: Apache-2.0
// One ping on its way to the topside, in the order and at the times at which a head sends it.
#pragma once

#include <optional>
#include <vector>

#include "protocol/common/shared_bytes.hpp"
#include "protocol/gemini/encoded_ping.hpp"
#include "protocol/gemini/pacer.hpp"

namespace sonard::gemini {

/// Three rules say when a datagram leaves (docs/protocols/gemini.md 8.5): never before the sound of its range
/// is back; paced by the Pacer; and the last 36 lines and the tail close together, because clients take slow
/// last lines for a lost tail. After the tail it stays as the copy that retries are served from.
class PingTransmission {
 public:
  /// `compression_log2` native lines per line as a power of two; `transmit_time` is that of the pulse.
  PingTransmission(EncodedPing ping, TimePoint transmit_time, int compression_log2);

  const EncodedPing& ping() const { return ping_; }
  bool finished() const { return next_ == ping_.datagram_count(); }
  /// Lines sent so far.
  int lines_sent() const;
  /// When the tail left; nullopt until then.
  std::optional<TimePoint> tail_sent_at() const { return tail_sent_at_; }

  /// Appends what may leave now to `out`.
  void send(TimePoint now, Pacer& pacer, std::vector<SharedBytes>& out);
  /// When send() is next worth calling; requires !finished(). Lines are collected to small bursts.
  TimePoint next_send(const Pacer& pacer) const;
  /// When the tail will have left if no call comes late; requires !finished().
  TimePoint predicted_end(const Pacer& pacer) const;

 private:
  TimePoint available_at(int index) const;

  EncodedPing ping_;
  TimePoint transmit_time_;
  int compression_log2_;
  int next_ = 0;  ///< index as in EncodedPing::datagram
  std::optional<TimePoint> tail_sent_at_;
};

}  // namespace sonard::gemini
