// SPDX-License-Identifier: Apache-2.0
// The checksum of MAVLink frames (MAVLink guide, "Packet Serialization"): CRC-16/MCRF4XX, which the guide
// calls X.25.
#pragma once

#include <cstdint>
#include <span>

namespace sonard::mavlink {

/// Checksum of `bytes` followed by `seed`. The seed depends on the definition of the message, so that
/// programs with different definitions reject each other's messages.
std::uint16_t checksum(std::span<const std::uint8_t> bytes, std::uint8_t seed);

}  // namespace sonard::mavlink
