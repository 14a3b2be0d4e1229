// SPDX-License-Identifier: Apache-2.0
// Transmission of one ping to the client, in the order and at the times of a real head.
#pragma once

#include <optional>
#include <vector>

#include "protocol/common/shared_bytes.hpp"
#include "protocol/gemini/encoded_ping.hpp"
#include "protocol/gemini/pacer.hpp"

namespace sonard::gemini {

/// Three rules decide when a datagram leaves (protocol/gemini/README.md 8.5): not before the echo from its
/// range arrives; paced by the Pacer; and the last 36 lines and the tail close together, because clients
/// mistake slow last lines for a lost tail. After the tail the object serves retries.
class PingTransmission {
 public:
  /// 2^`compression_log2` native lines make one line; `transmit_time` is the start of the pulse.
  PingTransmission(EncodedPing ping, TimePoint transmit_time, int compression_log2);

  const EncodedPing& ping() const { return ping_; }
  bool finished() const { return next_ == ping_.datagram_count(); }
  /// Lines sent so far.
  int lines_sent() const;
  /// When the tail was sent; nullopt before.
  std::optional<TimePoint> tail_sent_at() const { return tail_sent_at_; }

  /// Appends the datagrams that may leave now to `out`.
  void send(TimePoint now, Pacer& pacer, std::vector<SharedBytes>& out);
  /// When to call send() next; requires !finished(). Collects lines into small bursts.
  TimePoint next_send(const Pacer& pacer) const;
  /// When the tail leaves if no call is late; requires !finished().
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
