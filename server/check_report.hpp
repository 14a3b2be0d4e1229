// SPDX-License-Identifier: Apache-2.0
// What `sonard check` prints, for people and for programs.
#pragma once

#include <filesystem>
#include <string>

#include "server/check.hpp"
#include "server/config/config_error.hpp"

namespace sonard::server {

/// Findings on stdout, warnings and problems on stderr, one a line.
void print_report(const std::filesystem::path& file, const CheckReport& report);

/// One JSON object (docs/deploy.md): "configuration", "good", "problems" and "warnings" with file, line,
/// column, key and message, "findings" with area and text, and "cost_ms" by head.
std::string report_json(const std::filesystem::path& file, const CheckReport& report);

/// report_json() of a file that could not be read: it has problems alone.
std::string report_json(const std::filesystem::path& file, const ConfigError& error);

}  // namespace sonard::server
