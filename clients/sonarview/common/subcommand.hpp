// SPDX-License-Identifier: Apache-2.0
// A subcommand of sonarview: the viewer of one type of device, or the comparison of images.
#pragma once

#include <functional>
#include <span>

#include "clients/sonarview/common/exit_status.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

/// Runs the program. @throws std::exception, whose what() is shown to the user
using Run = std::function<ExitStatus()>;
/// Reads the options after parsing. @throws CLI::ValidationError
using Prepare = std::function<Run()>;

struct Subcommand {
  const char* name;
  const char* summary;
  const char* footer;
  /// Declares the options. `app` and the returned function must live until `app` has parsed.
  Prepare (*declare)(CLI::App& app);
};

/// One per type of device, in the order of cmake/devices.cmake; the build generates this function from it.
/// sonarview without a subcommand runs the first.
std::span<const Subcommand> device_subcommands();

}  // namespace sonard::client
