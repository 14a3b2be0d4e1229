// SPDX-License-Identifier: Apache-2.0
// Reads the section `web` of the configuration.
#pragma once

#include "server/web/web_config.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

WebConfig read_web(YamlSection& section);

}  // namespace sonard::server
