#include "protocol/micron/sweep.hpp"

#include <algorithm>
#include <cstdlib>

namespace sonard::micron {
namespace {

constexpr int step_of_zero = 16;

}  // namespace

void Sweep::configure(const HeadCommand& command, int bearing) {
  const bool swap = order_ == LimitsOrder::swapped && command.left_limit > command.right_limit;
  left_ = wrapped(swap ? command.right_limit : command.left_limit);
  width_ = wrapped((swap ? command.left_limit : command.right_limit) - left_);
  step_ = command.step == 0 ? step_of_zero : command.step;
  clockwise_ = command.has(control_bits::scan_right);
  bearing_ = wrapped(bearing);

  const bool stares =
      command.has(control_bits::stare) || (!command.has(control_bits::continuous) && width_ == 0);
  if (command.has(control_bits::motor_off)) {
    mode_ = Mode::still;
  } else if (stares) {
    mode_ = Mode::still;
    bearing_ = left_;
  } else if (command.has(control_bits::continuous)) {
    mode_ = Mode::continuous;
  } else {
    mode_ = Mode::sector;
    bearing_ = offset() <= width_ ? bearing_ : nearer_limit(bearing_);
  }
}

int Sweep::nearer_limit(int bearing) const {
  const int right = wrapped(left_ + width_);
  return std::abs(shortest_turn(bearing, left_)) <= std::abs(shortest_turn(bearing, right)) ? left_ : right;
}

SweepCode Sweep::code() const {
  if (mode_ != Mode::sector) {
    return SweepCode::normal;
  }
  if (offset() == 0) {
    return SweepCode::left_limit;
  }
  return offset() == width_ ? SweepCode::right_limit : SweepCode::normal;
}

int Sweep::step() {
  switch (mode_) {
    case Mode::still:
      return 0;
    case Mode::continuous:
      bearing_ = wrapped(bearing_ + (clockwise_ ? step_ : -step_));
      return step_;
    case Mode::sector:
      break;
  }
  if (offset() == (clockwise_ ? width_ : 0)) {
    clockwise_ = !clockwise_;
  }
  const int before = offset();
  const int after = std::clamp(before + (clockwise_ ? step_ : -step_), 0, width_);
  bearing_ = wrapped(left_ + after);
  return std::abs(after - before);
}

}  // namespace sonard::micron
