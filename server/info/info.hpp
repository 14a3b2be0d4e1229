// SPDX-License-Identifier: Apache-2.0
// `sonard info`: the contents of a log.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace sonard::server {

struct InfoOptions {
  bool json = false;
  std::optional<std::filesystem::path> pictures;  ///< folder for thumbnails
  std::uint64_t every = 1;                        ///< one picture per so many pings
  std::optional<double> utc_offset_h;             ///< of a .glf's times; nullopt: this machine's zone
};

/// Prints the contents to standard output, and problems of the log to standard error. @throws Error
void info(const std::filesystem::path& log, const InfoOptions& options);

}  // namespace sonard::server
