// SPDX-License-Identifier: Apache-2.0
// The .cfg entry of a .glf: XML with the writer, the times and the sonars of the log.
// Source: protocol/glf/README.md 1.2. No state; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::glf {

struct LogConfig {
  std::string app_name;                   ///< name and version of the writer; UTF-8
  double creation_time_s = 0.0;           ///< on the log's clock (log_time.hpp), rounded to milliseconds
  double close_time_s = 0.0;              ///< on the log's clock, rounded to milliseconds
  std::vector<std::uint16_t> device_ids;  ///< IDs of the Geminis in the log
};

std::string config_xml(const LogConfig& config);

}  // namespace sonard::glf
