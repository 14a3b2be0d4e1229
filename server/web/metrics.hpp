// SPDX-License-Identifier: Apache-2.0
// Status in the Prometheus text format, version 0.0.4.
#pragma once

#include <chrono>
#include <string>

#include "server/web/status.hpp"

namespace sonard::server {

/// The response to GET /metrics. Every name begins with "sonard_"; docs/page.md lists them.
std::string metrics_text(const DaemonIdentity& identity, const DaemonStatus& status,
                         std::chrono::duration<double> uptime);

}  // namespace sonard::server
