// SPDX-License-Identifier: Apache-2.0
// Repeated timing: what a run takes, and how sure that is.
#pragma once

#include <vector>

namespace sonard::bench {

/// Seconds since some start.
double now_s();
inline constexpr double ms_per_s = 1e3;

/// Times of one thing done again and again, in any unit.
class Timing {
 public:
  void add(double duration) { durations_.push_back(duration); }
  bool empty() const { return durations_.empty(); }
  /// The middle one, or the mean of the two in the middle. NaN when nothing was timed, as for all below.
  double median() const;
  /// The smallest that at least this share of them, 0 to 1, does not exceed.
  double quantile(double share) const;
  double p95() const { return quantile(0.95); }
  double min() const;

 private:
  std::vector<double> sorted() const;
  std::vector<double> durations_;
};

/// How often to repeat: at least `fewest`, then until `budget_s` is spent or `most` are done.
struct Repetition {
  int fewest = 5;
  int most = 101;
  double budget_s = 1.0;

  /// Another one, after `done` runs since `start_s`?
  bool wants_more(int done, double start_s) const {
    return done < fewest || (done < most && now_s() - start_s < budget_s);
  }
};

}  // namespace sonard::bench
