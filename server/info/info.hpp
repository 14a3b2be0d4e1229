// SPDX-License-Identifier: Apache-2.0
// `sonard info`: what is in a log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace sonard::server {

struct InfoOptions {
  bool json = false;
  std::optional<std::filesystem::path> pictures;  ///< folder for thumbnails
  std::uint64_t every = 1;                        ///< of the pings that have one
  std::optional<double> utc_offset_h;             ///< of a .glf; nullopt: this machine's zone
};

/// Prints to standard output, and to standard error what is wrong with the log. @throws LogError
void info(const std::filesystem::path& log, const InfoOptions& options);

}  // namespace sonard::server
