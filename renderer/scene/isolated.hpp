// SPDX-License-Identifier: Apache-2.0
// Runs third-party file readers in a child process, which contains their faults.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "renderer/scene/reader_jail.hpp"

namespace sonard::render {

/// The reader crashed, ran too long or failed; what() has the reason.
struct IsolatedFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct IsolatedResult {
  std::string bytes;  ///< the return value of the work
  std::string log;    ///< its output to stdout and stderr
};

/// Calls `work` in a forked child, confined by `jail`, and returns its bytes. The mesh and image libraries
/// crash or loop on some damaged files, print to the terminal and keep global state; the child contains these
/// effects. A child is killed beyond its processor limit, or beyond a wall-clock limit of one minute plus 20
/// times the processor limit. Call it at start-up, before other threads use the libraries that `work` uses.
/// @param prepare runs in the child before it is confined, to load libraries; may be empty
/// @throws IsolatedFailure; also with the message of an exception that `work` threw.
IsolatedResult run_isolated(const std::function<std::string()>& work, const ReaderJail& jail,
                            const std::function<void()>& prepare = {});

}  // namespace sonard::render
