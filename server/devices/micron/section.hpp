// SPDX-License-Identifier: Apache-2.0
// The part of the loader that reads a head of type `micron`.
#pragma once

#include "server/config/head_section.hpp"
#include "server/devices/micron/config.hpp"

namespace sonard::server {

/// @param head has the defaults, and gets what the section says, but for `head.device`
MicronConfig read_micron_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
