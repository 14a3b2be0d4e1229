#include "protocol/micron/sweep.hpp"

#include <algorithm>
#include <cstdlib>

namespace sonard::micron {
namespace {

int left_limit(const HeadCommand& command, LimitsOrder order) {
  const bool swap = order == LimitsOrder::swapped && command.left_limit > command.right_limit;
  return wrapped(swap ? command.right_limit : command.left_limit);
}

}  // namespace

int sector_width(const HeadCommand& command, LimitsOrder order) {
  if (command.left_limit == command.right_limit) {
    return 0;
  }
  const bool swap = order == LimitsOrder::swapped && command.left_limit > command.right_limit;
  const int width = wrapped(command.right_limit - command.left_limit);
  return width == 0 ? units_per_turn : swap ? units_per_turn - width : width;
}

bool stares(const HeadCommand& command) {
  return command.has(control_bits::stare) ||
         (!command.has(control_bits::continuous) && command.left_limit == command.right_limit);
}

void Sweep::configure(const HeadCommand& command, int bearing) {
  left_ = left_limit(command, order_);
  width_ = sector_width(command, order_);
  step_ = command.step == 0 ? step_of_zero : command.step;
  clockwise_ = command.has(control_bits::scan_right);
  offset_ = wrapped(bearing - left_);
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
  const int offset = wrapped(bearing - left_);
  if (offset <= width_) {
    return offset;
  }
  const int beyond = offset - width_;            // clockwise from the right limit
  const int short_of = units_per_turn - offset;  // counter-clockwise from the left one
  return short_of <= beyond ? 0 : width_;
}

SweepCode Sweep::code() const {
  if (mode_ != Mode::sector) {
    return SweepCode::normal;
  }
  if (offset_ == 0) {
    return SweepCode::left_limit;
  }
  return offset_ == width_ ? SweepCode::right_limit : SweepCode::normal;
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
  const bool at_end = before == (clockwise_ ? width_ : 0);
  clockwise_ = clockwise_ != at_end;
  offset_ = std::clamp(before + (at_end ? -turn : turn), 0, width_);
  return std::abs(offset_ - before);
}

}  // namespace sonard::micron
