// SPDX-License-Identifier: Apache-2.0
// Repairs the logs that a killed daemon has left behind (docs/logs.md, "Recording").
#pragma once

#include <filesystem>
#include <vector>

namespace sonard::server {

/// Repairs the logs of a folder that no program writes into. MCAP and pcapng files that do not end as they
/// should are cut after their last whole record and ended; .dat files are returned, for GlfPacking. Where
/// what is to be cut off is not just a record that was being written, the file is kept as it was under its
/// name with ".damaged" behind it, and what was whole goes into a new one. Each file that was touched gets a
/// line in the log.
/// @return the .dat files to be packed, the oldest name first
std::vector<std::filesystem::path> recover_logs(const std::filesystem::path& directory);

}  // namespace sonard::server
