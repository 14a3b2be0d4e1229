// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/sweep.hpp"

#include <algorithm>
#include <cstdlib>

namespace sonard::micron {

Sector sector_of(const HeadCommand& command, LimitsOrder order) {
  const int left = wrapped(command.left_limit), right = wrapped(command.right_limit);
  if (left == right) {
    return {left, command.left_limit == command.right_limit ? 0 : units_per_turn};
  }
  const bool swap = order == LimitsOrder::swapped && left > right;
  return swap ? Sector{right, left - right} : Sector{left, wrapped(right - left)};
}

bool stares(const HeadCommand& command) {
  return command.has(control_bits::stare) ||
         (!command.has(control_bits::continuous) && command.left_limit == command.right_limit);
}

void Sweep::configure(const HeadCommand& command, int bearing) {
  sector_ = sector_of(command, order_);
  step_ = command.step == 0 ? step_of_zero : command.step;
  clockwise_ = command.has(control_bits::scan_right);
  offset_ = wrapped(bearing - sector_.left);
  if (command.has(control_bits::motor_off)) {
    mode_ = Mode::still;
  } else if (stares(command)) {
    mode_ = Mode::still;
    offset_ = 0;
  } else if (command.has(control_bits::continuous)) {
    mode_ = Mode::continuous;
  } else {
    mode_ = Mode::sector;
    offset_ = offset_of(bearing);
  }
}

int Sweep::offset_of(int bearing) const {
  const int offset = wrapped(bearing - sector_.left);
  if (offset <= sector_.width) {
    return offset;
  }
  const int beyond = offset - sector_.width;     // clockwise from the right limit
  const int short_of = units_per_turn - offset;  // counter-clockwise from the left limit
  return short_of <= beyond ? 0 : sector_.width;
}

SweepCode Sweep::code() const {
  if (mode_ != Mode::sector) {
    return SweepCode::normal;
  }
  if (offset_ == 0) {
    return SweepCode::left_limit;
  }
  return offset_ == sector_.width ? SweepCode::right_limit : SweepCode::normal;
}

int Sweep::step() {
  const int turn = clockwise_ ? step_ : -step_;
  switch (mode_) {
    case Mode::still:
      return 0;
    case Mode::continuous:
      offset_ = wrapped(offset_ + turn);
      return step_;
    case Mode::sector:
      break;
  }
  const int before = offset_;
  const bool at_end = before == (clockwise_ ? sector_.width : 0);
  clockwise_ = clockwise_ != at_end;
  offset_ = std::clamp(before + (at_end ? -turn : turn), 0, sector_.width);
  return std::abs(offset_ - before);
}

}  // namespace sonard::micron
