// SPDX-License-Identifier: Apache-2.0
// Where one turn of a scan ends and the next begins.
#pragma once

#include <optional>

#include "clients/sonarview/common/sweep_pictures.hpp"
#include "protocol/ping360/host.hpp"

namespace sonard::client {

/// Sorts pings into turns by their angles alone: a turn ends where the head has come round, or turns back.
class SweepCollector {
 public:
  /// @param ahead the angle that is drawn upwards, gradians
  explicit SweepCollector(bool all_round, int ahead = 0) : all_round_(all_round), ahead_(ahead) {}

  /// The next ping. Returns the turn that was complete before it.
  std::optional<Sweep> add(const ping360::ReceivedPing& ping);
  const Sweep& current() const { return current_; }

 private:
  bool all_round_;
  int ahead_;
  Sweep current_;
  std::optional<int> last_;  ///< angle
  int way_ = 0;              ///< from the first ping of the turn to the last, gradians, clockwise
};

}  // namespace sonard::client
