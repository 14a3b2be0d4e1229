// SPDX-License-Identifier: Apache-2.0
// Runs foreign file readers where their faults cannot hurt: in a child process.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "renderer/scene/reader_jail.hpp"

namespace sonard::render {

/// The reader crashed, ran too long or gave up; what() says which.
struct IsolatedFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct IsolatedResult {
  std::string bytes;  ///< what the work returned
  std::string log;    ///< what it printed meanwhile
};

/// Calls `work` in a forked child, confined by `jail`, and hands back the bytes it returns. The mesh and
/// image libraries crash or loop on some damaged files, print to the terminal and keep global state; none of
/// that reaches this process. A child that uses more than its processor time, or takes a minute and 20 times
/// as long by the wall clock, is stopped. Called at start-up, before other threads use the libraries that
/// `work` uses.
/// @param prepare runs in the child before it is confined, to load libraries; may be empty
/// @throws IsolatedFailure; also with the message of an exception that `work` threw.
IsolatedResult run_isolated(const std::function<std::string()>& work, const ReaderJail& jail,
                            const std::function<void()>& prepare = {});

}  // namespace sonard::render
