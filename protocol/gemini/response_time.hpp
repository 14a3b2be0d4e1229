// SPDX-License-Identifier: Apache-2.0
// How long a peer takes to answer, learned from its answers.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace sonard::gemini {

/// Smoothed mean and deviation as TCP keeps them (RFC 6298), and the time after which an answer counts as
/// lost.
class ResponseTime {
 public:
  using Duration = std::chrono::nanoseconds;

  struct Limits {
    Duration initial;  ///< patience before the first sample
    Duration least;
    Duration most;
  };

  explicit ResponseTime(const Limits& limits) : limits_(limits) {}

  /// Takes the response time of a question asked once; that of a repeated question says nothing.
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

  /// Time to wait for an answer before the question is asked again.
  Duration patience() const {
    return mean_ ? std::clamp(*mean_ + 4 * deviation_, limits_.least, limits_.most) : limits_.initial;
  }

 private:
  Limits limits_;
  std::optional<Duration> mean_;
  Duration deviation_{};
};

}  // namespace sonard::gemini
