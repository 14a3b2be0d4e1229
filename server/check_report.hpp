// SPDX-License-Identifier: Apache-2.0
// Output of `sonard check`, for people and for programs.
#pragma once

#include <filesystem>
#include <string>

#include "server/check.hpp"
#include "server/yaml/config_error.hpp"

namespace sonard::server {

/// Prints findings on stdout, warnings and problems on stderr, one per line.
void print_report(const std::filesystem::path& file, const CheckReport& report);

/// One JSON object (docs/deploy.md): "configuration", "good", "problems" and "warnings" with file, line,
/// column, key and message, "findings" with area and text, and "cost_ms" by head.
std::string report_json(const std::filesystem::path& file, const CheckReport& report);

/// report_json() of a file that could not be read: it has only problems.
std::string report_json(const std::filesystem::path& file, const ConfigError& error);

}  // namespace sonard::server
