// SPDX-License-Identifier: Apache-2.0
// Status in the text format of Prometheus, version 0.0.4.
#pragma once

#include <chrono>
#include <string>

#include "server/web/status.hpp"

namespace sonard::server {

/// The answer to GET /metrics. Every name begins with "sonard_"; docs/page.md lists them.
std::string metrics_text(const DaemonIdentity& identity, const DaemonStatus& status,
                         std::chrono::duration<double> uptime);

}  // namespace sonard::server
