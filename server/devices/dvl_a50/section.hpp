// SPDX-License-Identifier: Apache-2.0
// Reads the configuration of a DVL.
#pragma once

#include "server/devices/dvl_a50/config.hpp"
#include "server/heads/head_section.hpp"

namespace sonard::server {

DvlConfig read_dvl_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
