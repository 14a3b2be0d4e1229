// SPDX-License-Identifier: Apache-2.0
// The command line of sonarview.
#pragma once

#include <optional>

#include "clients/sonarview/common/subcommand.hpp"

namespace sonard::client {

/// nullopt: the program ends with `status`, after --help or an error, which has been printed.
std::optional<Run> parse_command_line(int argc, const char* const* argv, ExitStatus& status);

}  // namespace sonard::client
