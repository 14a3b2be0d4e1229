// SPDX-License-Identifier: Apache-2.0
// Repairs the logs of a killed daemon (docs/logs.md, "Recording").
#pragma once

#include <filesystem>
#include <vector>

namespace sonard::server {

/// Repairs the logs of a folder that no program writes to. MCAP and pcapng files without a proper end are cut
/// after their last whole record and ended; .dat files are returned, for GlfPacking. If the bytes to cut are
/// more than a partly written record, the original file is kept with ".damaged" appended to its name, and its
/// whole records before and after the damage go into a new file. Each changed file is logged, with its
/// losses.
/// @return the .dat files to pack, in the order of their names
std::vector<std::filesystem::path> recover_logs(const std::filesystem::path& directory);

}  // namespace sonard::server
