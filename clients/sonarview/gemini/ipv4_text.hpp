// SPDX-License-Identifier: Apache-2.0
// IPv4 addresses as people write them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace sonard::client {

/// "10.61.19.200" for 0x0A3D13C8.
std::string ipv4_text(std::uint32_t address);
/// The inverse; nullopt for anything but four decimal octets.
std::optional<std::uint32_t> parse_ipv4(const std::string& text);

}  // namespace sonard::client
