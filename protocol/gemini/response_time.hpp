// SPDX-License-Identifier: Apache-2.0
// Estimates how long a peer takes to answer.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace sonard::gemini {

/// Smoothed mean and deviation of response times as in TCP (RFC 6298), and the resulting time-out.
class ResponseTime {
 public:
  using Duration = std::chrono::nanoseconds;

  struct Limits {
    Duration initial;  ///< patience() before the first sample
    Duration least;
    Duration most;
  };

  explicit ResponseTime(const Limits& limits) : limits_(limits) {}

  /// Adds the response time of a request. Do not add repeated requests: their answers are ambiguous.
  void sample(Duration took) {
    if (!mean_) {
      mean_ = took;
      deviation_ = took / 2;
      return;
    }
    const Duration error = took - *mean_;
    deviation_ += (std::max(error, -error) - deviation_) / 4;
    *mean_ += error / 8;
  }

  /// Time to wait for an answer before repeating a request.
  Duration patience() const {
    return mean_ ? std::clamp(*mean_ + 4 * deviation_, limits_.least, limits_.most) : limits_.initial;
  }

 private:
  Limits limits_;
  std::optional<Duration> mean_;
  Duration deviation_{};
};

}  // namespace sonard::gemini
