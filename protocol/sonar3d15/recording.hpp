// SPDX-License-Identifier: Apache-2.0
// Files `.sonar`: packets one after another, without a header or bytes between them. To write a file, append
// each datagram. Source: protocol/sonar3d15/README.md 9.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "protocol/common/damage.hpp"

namespace sonard::sonar3d15 {

/// Calls `take` for each packet with a right checksum, of any type. After unreadable bytes, reading continues
/// at the next packet that is readable. @return the unreadable parts, in order; the offset in an error is
/// from the start of the file
std::vector<Damage> for_each_packet(std::span<const std::uint8_t> file,
                                    const std::function<void(std::span<const std::uint8_t>)>& take);

}  // namespace sonard::sonar3d15
