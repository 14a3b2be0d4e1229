// SPDX-License-Identifier: Apache-2.0
// Running a program to its end, from a test.
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace sonard::test {

struct ProcessResult {
  int exit_code = -1;      ///< 128 + the signal when one ended it
  bool timed_out = false;  ///< it was killed at the deadline
  std::string out;
  std::string err;
};

/// Runs `command` (found along PATH), its input empty, and waits until it ends or the time is up.
/// @throws std::system_error when it cannot be started
ProcessResult run_process(const std::vector<std::string>& command,
                          std::chrono::milliseconds deadline = std::chrono::seconds{60});

}  // namespace sonard::test
