#include "server/info/recorded_turns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>

#include "protocol/micron/units.hpp"

namespace sonard::server {
namespace {

constexpr int most_step = 255;

bool same_bins(const RecordedScanLine& a, const RecordedScanLine& b) {
  return a.settings.lines == b.settings.lines && a.settings.line_step_m == b.settings.line_step_m &&
         a.bits_per_bin == b.bits_per_bin;
}

/// A turn as it grows.
class GrowingTurn {
 public:
  GrowingTurn(const RecordedScanLine& line, std::size_t place)
      : first_(&line), begin_(place), end_(place + 1), left_(picture_bearing(line)), last_(left_) {}

  /// False when the line belongs to the next one.
  bool take(const RecordedScanLine& line) {
    const int bearing = picture_bearing(line);
    const int way = micron::shortest_turn(last_, bearing);
    const bool back = way != 0 && way_ != 0 && (way > 0) != (way_ > 0);
    if (!same_bins(*first_, line) || back || std::abs(way_ + way) >= micron::units_per_turn ||
        end_ - begin_ >= micron::units_per_turn) {
      return false;
    }
    way_ += way;
    ++steps_[std::abs(way)];
    last_ = bearing;
    left_ = way < 0 ? bearing : left_;
    ++end_;
    return true;
  }

  RecordedTurn done() const {
    RecordedTurn turn;
    turn.begin = begin_;
    turn.end = end_;
    turn.shape.step = usual_step();
    turn.shape.left = left_;
    turn.shape.width = std::max(std::abs(way_), turn.shape.step);
    turn.shape.bins = first_->settings.lines;
    turn.shape.bin_m = first_->settings.line_step_m;
    if (turn.shape.full_circle()) {
      turn.shape.left = 0;
      turn.shape.width = micron::units_per_turn;
    }
    return turn;
  }

 private:
  /// The one that comes most often; a line that is missing makes a longer one.
  int usual_step() const {
    const auto usual = std::ranges::max_element(steps_, {}, [](const auto& step) { return step.second; });
    const int step = usual == steps_.end() ? 0 : usual->first;
    return step == 0 ? picture::TurnShape{}.step : std::min(step, most_step);
  }

  const RecordedScanLine* first_;
  std::size_t begin_;
  std::size_t end_;
  int left_;     ///< bearing farthest counter-clockwise
  int last_;     ///< bearing of the last line
  int way_ = 0;  ///< from the first line to the last, clockwise
  std::map<int, std::size_t> steps_;
};

}  // namespace

int picture_bearing(const RecordedScanLine& line) {
  constexpr double units_per_rad = micron::units_per_turn / (2.0 * std::numbers::pi);
  const double turns = std::remainder(-line.bearing_rad, 2.0 * std::numbers::pi);
  return micron::wrapped(micron::bearing_ahead + static_cast<int>(std::lround(turns * units_per_rad)));
}

std::vector<RecordedTurn> turns_of(const RecordedScan& scan) {
  std::vector<RecordedTurn> turns;
  GrowingTurn turn(scan.lines.front(), 0);
  for (std::size_t i = 1; i < scan.lines.size(); ++i) {
    if (!turn.take(scan.lines[i])) {
      turns.push_back(turn.done());
      turn = GrowingTurn(scan.lines[i], i);
    }
  }
  turns.push_back(turn.done());
  return turns;
}

}  // namespace sonard::server
