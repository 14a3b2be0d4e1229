// SPDX-License-Identifier: Apache-2.0
// Reads the shots of a .sonar, of sonard or of a real head (protocol/sonar3d15/README.md 9).
#pragma once

#include <memory>
#include <string>

#include "server/logs/log_reader.hpp"

namespace sonard::server {

/// A shot is a range image with the signal image that follows it and has the same header. Other packets are
/// counted.
/// @param type the type's name in the configuration
/// @throws Error if the log holds no packet
std::unique_ptr<LogReader> read_sonar3d15_log(const LogFile& file, const std::string& type);

}  // namespace sonard::server
