// SPDX-License-Identifier: Apache-2.0
// The checksum of MAVLink frames (MAVLink guide, "Packet Serialization": CRC-16/MCRF4XX, which the guide
// names after X.25).
#pragma once

#include <cstdint>
#include <span>

namespace sonard::mavlink {

/// Checksum of `bytes` followed by `seed`, which stands for the definition of the message: two programs that
/// lay out a message differently do not accept each other's.
std::uint16_t checksum(std::span<const std::uint8_t> bytes, std::uint8_t seed);

}  // namespace sonard::mavlink
