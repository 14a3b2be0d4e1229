// SPDX-License-Identifier: Apache-2.0
// Reads the configuration of a Ping1D or Ping2.
#pragma once

#include "server/devices/ping1d/config.hpp"
#include "server/heads/head_section.hpp"

namespace sonard::server {

Ping1dConfig read_ping1d_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
