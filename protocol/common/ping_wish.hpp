// How a head whose pings follow somebody else's time says which one it would begin.
#pragma once

#include <chrono>

namespace sonard {

/// The ping that a head would begin next, were it permitted.
struct PingWish {
  std::chrono::nanoseconds from{};       ///< not before this, on the clock that the head is given
  std::chrono::nanoseconds period{};     ///< from the last ping to this one, in whatever time rules
  std::chrono::nanoseconds listening{};  ///< until its last echo is back, in the same
};

}  // namespace sonard
