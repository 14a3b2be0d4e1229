// SPDX-License-Identifier: Apache-2.0
// Repeated timing, with quantiles.
#pragma once

#include <vector>

namespace sonard::bench {

/// Seconds since an arbitrary start.
double now_s();
inline constexpr double ms_per_s = 1e3;

/// Times of repeated runs, in any unit.
class Timing {
 public:
  void add(double duration) { durations_.push_back(duration); }
  bool empty() const { return durations_.empty(); }
  /// The median. NaN if nothing was timed; this holds for all functions below.
  double median() const;
  /// The smallest time that at least this share (0 to 1) of the times does not exceed.
  double quantile(double share) const;
  double p95() const { return quantile(0.95); }
  double min() const;

 private:
  std::vector<double> sorted() const;
  std::vector<double> durations_;
};

/// Number of repetitions: at least `fewest`, then until `budget_s` is spent or `most` are done.
struct Repetition {
  int fewest = 5;
  int most = 101;
  double budget_s = 1.0;

  /// Whether to run again, after `done` runs since `start_s`.
  bool wants_more(int done, double start_s) const {
    return done < fewest || (done < most && now_s() - start_s < budget_s);
  }
};

}  // namespace sonard::bench
