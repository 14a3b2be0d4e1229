// SPDX-License-Identifier: Apache-2.0
// File names of a recording (docs/logs.md, "Recording").
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sonard::server {

/// "2026-11-20-142233", or "2026-11-20-142233_bow" for logs of one head. If such a file exists, "-2", "-3"
/// and so on is appended.
/// @param time_s on the clock of the log (protocol/glf/log_time.hpp)
std::string free_stem(const std::filesystem::path& directory, double time_s, std::string_view head = {});

std::filesystem::path mcap_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path pcapng_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path sonar_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path dat_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path glf_path(const std::filesystem::path& directory, const std::string& stem);
/// Name of a .glf until it is whole.
std::filesystem::path unfinished_glf_path(const std::filesystem::path& directory, const std::string& stem);

/// Stem of a .dat's name; empty if the file is not named like sonard's.
std::string stem_of_dat(const std::filesystem::path& path);

}  // namespace sonard::server
