// SPDX-License-Identifier: Apache-2.0
// Writes small pictures of the pings and turns of a log.
#pragma once

#include <cstdint>
#include <filesystem>

#include "server/logs/log_reader.hpp"

namespace sonard::server {

/// Writes each `every`-th ping of each multibeam head as a fan seen from above, and each `every`-th sweep of
/// each scanning head (recorded_sweeps.hpp): FOLDER/<name or id>_000012.png, where 0 is the head's first.
/// Creates the folder; overwrites files.
/// @return number of files. @throws Error naming the file that cannot be written or the head that cannot
/// be drawn
std::uint64_t write_thumbnails(const LogReader& reader, const LogFile& file,
                               const std::filesystem::path& folder, std::uint64_t every);

}  // namespace sonard::server
