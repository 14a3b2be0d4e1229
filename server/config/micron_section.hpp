// The part of the loader that reads a head of type `micron`.
#pragma once

#include "server/config/head_section.hpp"

namespace sonard::server {

MicronHeadConfig read_micron_head(YamlSection& section, const HeadContext& context,
                                  std::vector<ConfigWarning>& warnings);

}  // namespace sonard::server
