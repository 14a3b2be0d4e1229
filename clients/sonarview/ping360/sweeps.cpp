// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping360/sweeps.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <set>
#include <utility>

#include "protocol/ping360/units.hpp"

namespace sonard::client {

Sweep360 with_pings_before(Sweep360 sweep, const std::optional<Sweep360>& before) {
  std::set<int> angles;
  for (const ping360::ReceivedPing& ping : sweep.pings) {
    angles.insert(ping.form.settings.angle);
  }
  std::vector<ping360::ReceivedPing> older;
  if (before) {
    std::copy_if(
        before->pings.begin(), before->pings.end(), std::back_inserter(older),
        [&](const ping360::ReceivedPing& ping) { return angles.count(ping.form.settings.angle) == 0; });
  }
  sweep.pings.insert(sweep.pings.begin(), older.begin(), older.end());
  return sweep;
}

std::optional<Sweep360> SweepCollector::add(const ping360::ReceivedPing& ping) {
  const int angle = ping.form.settings.angle;
  const int step = last_ ? ping360::shortest_turn(*last_, angle) : 0;
  const bool round = std::abs(way_ + step) >= ping360::gradians_per_turn;
  const bool back = !all_round_ && way_ != 0 && step != 0 && (way_ > 0) != (step > 0);
  std::optional<Sweep360> done;
  if (round || back) {
    Sweep360 next;
    next.number = current_.number + 1;
    done = std::exchange(current_, std::move(next));
    way_ = 0;
  } else {
    way_ += step;
  }
  last_ = angle;
  current_.pings.push_back(ping);
  return done;
}

}  // namespace sonard::client
