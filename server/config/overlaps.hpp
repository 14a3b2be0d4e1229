// What two heads, or a head and a pose input, must not share.
#pragma once

#include <string>
#include <vector>

#include "server/config/config.hpp"
#include "server/config/config_error.hpp"

namespace sonard::server {

/// A socket that the configuration asks for.
struct PlannedSocket {
  Endpoint endpoint;
  std::string key;  ///< "heads[0].network.bind"
};

/// Of pose input first, then of each head.
std::vector<PlannedSocket> planned_udp_sockets(const DaemonConfig& config);
std::vector<PlannedSocket> planned_tcp_sockets(const DaemonConfig& config);

/// Sockets that clash; names, sonar IDs, alternate addresses and links given twice.
std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions);

}  // namespace sonard::server
