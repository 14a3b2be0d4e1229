// SPDX-License-Identifier: Apache-2.0
// Reads the configuration of a Sonar 3D-15.
#pragma once

#include "server/devices/sonar3d15/config.hpp"
#include "server/heads/head_section.hpp"

namespace sonard::server {

Sonar3d15Config read_sonar3d15_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
