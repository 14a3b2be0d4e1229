// SPDX-License-Identifier: Apache-2.0
// Messages of a pose source that gave no pose, for its findings.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Counts messages until a pause of `worth_saying`. Reads no clock.
class UnreadableMessages {
 public:
  static constexpr std::chrono::minutes worth_saying{1};

  void note(TimePoint now, std::string sender, std::string problem);
  /// "91 messages from 127.0.0.1:41234 could not be read: " and the first problem; or empty.
  /// @param sender of the first; may be empty
  std::string text(TimePoint now) const;

 private:
  std::uint64_t count_ = 0;
  std::string sender_, problem_;  ///< of the first
  TimePoint newest_{};
};

/// What to do if the bytes look like MAVLink, to be added to the reason why they are no pose message; empty
/// if they do not begin with a MAVLink frame.
std::string mavlink_hint(std::span<const std::uint8_t> bytes);

}  // namespace sonard::server
