// SPDX-License-Identifier: Apache-2.0
// Waits with a deadline, so that a test fails instead of hanging.
#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace sonard::test {

/// Returns true as soon as the condition holds, false if it does not hold within the time.
inline bool wait_for(const std::function<bool()>& condition,
                     std::chrono::milliseconds limit = std::chrono::seconds{10}) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) {
      return false;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
  return true;
}

}  // namespace sonard::test
