// SPDX-License-Identifier: Apache-2.0
// Runs a program to its end, for tests.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace sonard::test {

struct ProcessResult {
  int exit_code = -1;      ///< 128 + the signal if a signal ended it
  bool timed_out = false;  ///< killed at the deadline
  std::string out;
  std::string err;
};

/// Runs `command` (found in PATH) with empty input, and waits until it ends or the time is over.
/// @throws std::system_error if it cannot be started
ProcessResult run_process(const std::vector<std::string>& command,
                          std::chrono::milliseconds deadline = std::chrono::seconds{60});

}  // namespace sonard::test
