// SPDX-License-Identifier: Apache-2.0
// A line of a Micron as logs keep it, and back: what goes to a log, and how a head sends what comes from one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

inline constexpr double carrier_hz = 700'000.0;  ///< of the sound (docs/protocols/micron.md 10)

/// PingRecord::wire of a line: a frame without data.
/// @param line its data are left out
/// @param node the address of the head that sent it
std::vector<std::uint8_t> recorded_wire(const HeadData& line, std::uint8_t node);
/// The line in a message; nullopt where it holds none.
std::optional<HeadData> recorded_line(std::span<const std::uint8_t> wire);

/// How `asked` differs from what is sent in its place. Rounding of the wire and of logs is no difference.
std::vector<Difference> differences(const HeadCommand& asked, const PingJob& sent, const HeadData& recorded);

}  // namespace sonard::micron
