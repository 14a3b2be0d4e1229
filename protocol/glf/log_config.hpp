// SPDX-License-Identifier: Apache-2.0
// The .cfg entry of a .glf: XML that says who wrote the log, when, and of which sonars.
// Source: docs/logs.md 1.2. No state; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::glf {

struct LogConfig {
  std::string app_name;                   ///< of the writer, with its version; UTF-8
  double creation_time_s = 0.0;           ///< on the log's clock (log_time.hpp), kept to the millisecond
  double close_time_s = 0.0;              ///< the same
  std::vector<std::uint16_t> device_ids;  ///< of the Geminis in the log
};

std::string config_xml(const LogConfig& config);

}  // namespace sonard::glf
