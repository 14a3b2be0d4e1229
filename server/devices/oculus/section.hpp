// SPDX-License-Identifier: Apache-2.0
// The part of the loader that reads a head of type `oculus`.
#pragma once

#include "server/config/head_section.hpp"
#include "server/devices/oculus/config.hpp"

namespace sonard::server {

/// @param head has the defaults, and gets what the section says, but for `head.device`
OculusConfig read_oculus_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
