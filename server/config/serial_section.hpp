// The part of the loader that reads how clients reach a serial device.
#pragma once

#include <filesystem>

#include "server/config/config.hpp"
#include "server/config/yaml_section.hpp"

namespace sonard::server {

/// The keys `tcp`, `udp`, `pty` (lists) and `baud`. Reports a link without any transport, and transports of
/// one link that would get in each other's way.
/// @param folder of the configuration file, which links to ptys are relative to
SerialLinkConfig read_serial_link(YamlSection& section, const std::filesystem::path& folder);

}  // namespace sonard::server
