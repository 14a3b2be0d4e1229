// SPDX-License-Identifier: Apache-2.0
#include "server/info/recorded_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

namespace sonard::server {
namespace {

constexpr int most_step = 255;

bool same_bins(const LoggedPing& a, const LoggedPing& b) {
  return a.settings.bins == b.settings.bins && a.settings.bin_m == b.settings.bin_m &&
         a.bits_per_bin == b.bits_per_bin;
}

/// The shorter way from one bearing to another, positive clockwise, in 1/16 gradian.
int shortest_turn(int from, int to) {
  constexpr int turn = picture::units_per_turn;
  const int way = ((to - from) % turn + turn) % turn;
  return way > turn / 2 ? way - turn : way;
}

/// A sweep under construction.
class GrowingSweep {
 public:
  GrowingSweep(const LoggedPing& line, std::size_t place)
      : first_(&line), begin_(place), end_(place + 1), left_(picture_bearing(line)), last_(left_) {}

  /// Returns false if the line belongs to the next sweep.
  bool take(const LoggedPing& line) {
    const int bearing = picture_bearing(line);
    const int way = shortest_turn(last_, bearing);
    const bool back = way != 0 && way_ != 0 && (way > 0) != (way_ > 0);
    if (!same_bins(*first_, line) || back || std::abs(way_ + way) >= picture::units_per_turn ||
        end_ - begin_ >= picture::units_per_turn) {
      return false;
    }
    way_ += way;
    ++steps_[std::abs(way)];
    last_ = bearing;
    left_ = way < 0 ? bearing : left_;
    ++end_;
    return true;
  }

  RecordedSweep done() const {
    RecordedSweep sweep;
    sweep.begin = begin_;
    sweep.end = end_;
    sweep.shape.step = usual_step();
    sweep.shape.left = left_;
    sweep.shape.width = std::max(std::abs(way_), sweep.shape.step);
    sweep.shape.bins = first_->settings.bins;
    sweep.shape.bin_m = first_->settings.bin_m;
    if (sweep.shape.full_circle()) {
      sweep.shape.left = 0;
      sweep.shape.width = picture::units_per_turn;
    }
    return sweep;
  }

 private:
  /// The most frequent step; a missing line makes a longer one.
  int usual_step() const {
    const auto usual = std::ranges::max_element(steps_, {}, [](const auto& step) { return step.second; });
    const int step = usual == steps_.end() ? 0 : usual->first;
    return step == 0 ? picture::SweepShape{}.step : std::min(step, most_step);
  }

  const LoggedPing* first_;
  std::size_t begin_;
  std::size_t end_;
  int left_;     ///< bearing farthest counter-clockwise
  int last_;     ///< bearing of the last line
  int way_ = 0;  ///< sum of the steps, positive clockwise
  std::map<int, std::size_t> steps_;
};

}  // namespace

int picture_bearing(const LoggedPing& line) {
  return picture::turn_bearing(line.bearing_rad);
}

std::vector<RecordedSweep> sweeps_of(const LoggedHead& head) {
  std::vector<RecordedSweep> sweeps;
  GrowingSweep sweep(head.pings.front(), 0);
  for (std::size_t i = 1; i < head.pings.size(); ++i) {
    if (!sweep.take(head.pings[i])) {
      sweeps.push_back(sweep.done());
      sweep = GrowingSweep(head.pings[i], i);
    }
  }
  sweeps.push_back(sweep.done());
  return sweeps;
}

}  // namespace sonard::server
