// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/scan_sweeps.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "protocol/micron/units.hpp"

namespace sonard::client {

using micron::units_per_turn;
using micron::wrapped;

ScanSweeps::ScanSweeps(const micron::HeadCommand& parameters)
    : sector_(!parameters.has(micron::control_bits::continuous)),
      step_(parameters.step),
      left_(parameters.left_limit),
      length_(sector_ ? wrapped(parameters.right_limit - parameters.left_limit) : units_per_turn),
      clockwise_(parameters.has(micron::control_bits::scan_right)),
      begun_(!sector_) {}

std::optional<Sweep> ScanSweeps::add(const micron::ReceivedLine& line) {
  return sector_ ? add_in_sector(line) : add_all_round(line);
}

std::optional<Sweep> ScanSweeps::add_all_round(const micron::ReceivedLine& line) {
  std::optional<Sweep> done;
  const int bearing = line.head.bearing;
  const int way = last_ ? wrapped(clockwise_ ? bearing - *last_ : *last_ - bearing) : 0;
  last_ = bearing;
  count_missed(way);
  if (sweep_.lines.empty()) {
    travelled_ = 0;
  } else if (travelled_ + way >= length_) {  // the last lines of the turn are missing
    done = finish();
  } else {
    travelled_ += way;
  }
  take(line);
  if (travelled_ + step_ >= length_) {
    done = finish();
  }
  return done;
}

/// The head reverses at its limits, so a limit may lie between two lines.
std::optional<Sweep> ScanSweeps::add_in_sector(const micron::ReceivedLine& line) {
  std::optional<Sweep> done;
  // Measured from the middle, because a head may stop short of a limit or beyond it.
  const int place = micron::shortest_turn(left_ + length_ / 2, line.head.bearing) + length_ / 2;
  if (!begun_ && last_ && place != *last_) {
    clockwise_ = place > *last_;
  }
  const bool turned = last_ && place != *last_ && (place > *last_) != clockwise_;
  if (turned) {  // the line at the limit is missing
    const int limit = clockwise_ ? length_ : 0;
    count_missed((steps(std::abs(limit - *last_)) + steps(std::abs(place - limit))) * step_);
    done = finish();
    clockwise_ = !clockwise_;
  } else if (last_) {
    count_missed(std::abs(place - *last_));
  }
  last_ = place;
  travelled_ = std::clamp(clockwise_ ? place : length_ - place, 0, length_);
  if (begun_) {
    take(line);
  }
  const bool at_left = line.head.sweep == micron::SweepCode::left_limit || place <= 0;
  const bool at_right = line.head.sweep == micron::SweepCode::right_limit || place >= length_;
  if (at_left || at_right) {
    if (begun_ && sweep_.lines.size() > 1) {
      done = finish();
    }
    sweep_.lines.clear();
    sweep_.lines_missed = 0;
    begun_ = true;
    clockwise_ = at_left;
    travelled_ = 0;
    take(line);
  }
  return done;
}

void ScanSweeps::take(const micron::ReceivedLine& line) {
  sweep_.lines.push_back({line.head.bearing, line.bins});
}

int ScanSweeps::steps(int way) const {
  return (way + step_ - 1) / step_;
}

void ScanSweeps::count_missed(int way) {
  const auto missed = static_cast<std::uint64_t>(std::max(0, steps(way) - 1));
  sweep_.lines_missed += missed;
  lines_missed_ += missed;
}

Sweep ScanSweeps::finish() {
  Sweep next;
  next.number = sweep_.number + 1;
  travelled_ = 0;
  return std::exchange(sweep_, std::move(next));
}

void ScanSweeps::restart() {
  sweep_.lines.clear();
  sweep_.lines_missed = 0;
  last_.reset();
  travelled_ = 0;
  begun_ = !sector_;
}

double ScanSweeps::share() const {
  return std::min(1.0, static_cast<double>(travelled_) / length_);
}

}  // namespace sonard::client
