// SPDX-License-Identifier: Apache-2.0
// What files of a recording are called (docs/logs.md, "Recording").
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace sonard::server {

/// "2026-11-20-142233", for logs of one head "2026-11-20-142233_bow", and "..-2", "..-3" behind it where
/// files of that name are there already.
/// @param time_s on the clock of the log (protocol/glf/log_time.hpp)
std::string free_stem(const std::filesystem::path& directory, double time_s, std::string_view head = {});

std::filesystem::path mcap_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path pcapng_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path dat_path(const std::filesystem::path& directory, const std::string& stem);
std::filesystem::path glf_path(const std::filesystem::path& directory, const std::string& stem);
/// What a .glf is called until it is whole.
std::filesystem::path unfinished_glf_path(const std::filesystem::path& directory, const std::string& stem);

/// Stem of a .dat's name; empty when the file is not named as ours are.
std::string stem_of_dat(const std::filesystem::path& path);

}  // namespace sonard::server
