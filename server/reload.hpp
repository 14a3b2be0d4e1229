// SPDX-License-Identifier: Apache-2.0
// SIGHUP: the configuration is read again, and the daemon begins anew with it.
#pragma once

#include <filesystem>

namespace sonard::server {

/// Whether `sonard check --no-network`, in a process of its own, finds the configuration good. What is wrong
/// with it goes to the log. Blocks for as long as the world takes to load.
bool configuration_is_good(const std::filesystem::path& config);

/// Replaces the process by a new one with the same command line. Returns only where that fails, with errno
/// set.
/// @param argv of main()
void begin_anew(char** argv);

}  // namespace sonard::server
