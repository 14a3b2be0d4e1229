// SPDX-License-Identifier: Apache-2.0
// Reads the section of a head of type `micron`.
#pragma once

#include "server/devices/micron/config.hpp"
#include "server/heads/head_section.hpp"

namespace sonard::server {

/// @param head holds the defaults; values of the section replace them, except `head.device`
MicronConfig read_micron_head(YamlSection& section, const HeadContext& context, HeadConfig& head);

}  // namespace sonard::server
