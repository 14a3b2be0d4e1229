// SPDX-License-Identifier: Apache-2.0
// What two heads, or a head and a pose input, must not share.
#pragma once

#include <vector>

#include "server/config/config.hpp"
#include "server/config/config_error.hpp"
#include "server/config/head_kind.hpp"

namespace sonard::server {

/// Of pose input first, then of each head; keys are those of the whole configuration.
std::vector<PlannedSocket> planned_sockets(const DaemonConfig& config);

/// Sockets that clash, names given twice, and what else no two heads of a kind may share.
std::vector<ConfigProblem> find_overlaps(const DaemonConfig& config, const KeyPositions& positions);

}  // namespace sonard::server
