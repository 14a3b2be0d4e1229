// What two heads, or a head and a pose input, must not share.
#pragma once

#include <vector>

#include "server/config/config.hpp"
#include "server/config/config_error.hpp"

namespace sonard::server {

/// UDP sockets that clash; names, sonar IDs and alternate addresses given twice.
std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions);

}  // namespace sonard::server
