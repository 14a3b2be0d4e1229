// SPDX-License-Identifier: Apache-2.0
// Divides a scan into turns.
#pragma once

#include <optional>

#include "clients/sonarview/common/sweep_pictures.hpp"
#include "protocol/ping360/client.hpp"

namespace sonard::client {

/// Divides pings into turns by their angles only. A turn ends after a full circle, or when the head reverses.
class SweepCollector {
 public:
  /// @param ahead the angle that points up in pictures, gradians
  explicit SweepCollector(bool all_round, int ahead = 0) : all_round_(all_round), ahead_(ahead) {}

  /// Adds the next ping. Returns the turn that ended before it; nullopt if the turn continues.
  std::optional<Sweep> add(const ping360::ReceivedPing& ping);
  const Sweep& current() const { return current_; }

 private:
  bool all_round_;
  int ahead_;
  Sweep current_;
  std::optional<int> last_;  ///< angle of the last ping, gradians
  int way_ = 0;  ///< signed angle from the first ping of the turn to the last, gradians, clockwise
};

}  // namespace sonard::client
