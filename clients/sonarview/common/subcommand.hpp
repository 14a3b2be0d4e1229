// SPDX-License-Identifier: Apache-2.0
// Something that sonarview does, as its command line knows it: talking to one kind of device, or comparing
// images.
#pragma once

#include <functional>
#include <span>

#include "clients/sonarview/common/exit_status.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

/// What the program does. @throws std::exception, whose what() is for the user
using Run = std::function<ExitStatus()>;
/// Makes sense of the options once they are parsed. @throws CLI::ValidationError
using Prepare = std::function<Run()>;

struct Subcommand {
  const char* name;
  const char* summary;
  const char* footer;
  /// Declares its options; `app` and what is returned then live until they are parsed.
  Prepare (*declare)(CLI::App& app);
};

/// One for each kind of device, in the order of cmake/devices.cmake, from which the build writes this
/// function. The first is what sonarview does without a subcommand.
std::span<const Subcommand> device_subcommands();

}  // namespace sonard::client
