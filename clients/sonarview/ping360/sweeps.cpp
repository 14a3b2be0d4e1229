// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping360/sweeps.hpp"

#include <cstdlib>
#include <utility>

#include "protocol/ping360/units.hpp"

namespace sonard::client {

std::optional<Sweep> SweepCollector::add(const ping360::ReceivedPing& ping) {
  const int angle = ping.form.settings.angle;
  const int step = last_ ? ping360::shortest_turn(*last_, angle) : 0;
  const bool round = std::abs(way_ + step) >= ping360::gradians_per_turn;
  const bool back = !all_round_ && way_ != 0 && step != 0 && (way_ > 0) != (step > 0);
  std::optional<Sweep> done;
  if (round || back) {
    Sweep next;
    next.number = current_.number + 1;
    done = std::exchange(current_, std::move(next));
    way_ = 0;
  } else {
    way_ += step;
  }
  last_ = angle;
  current_.lines.push_back({picture::turn_bearing(ping360::bearing_rad(angle, ahead_)), ping.samples});
  return done;
}

}  // namespace sonard::client
