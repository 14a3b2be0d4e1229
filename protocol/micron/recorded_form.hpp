// SPDX-License-Identifier: Apache-2.0
// Conversion of a Micron's lines to log records and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

inline constexpr double carrier_hz = 700'000.0;  ///< of the sound (protocol/micron/README.md 10)

/// PingRecord::wire of a line: a frame without data.
/// @param line its data are ignored
/// @param node node of the head that sent it
std::vector<std::uint8_t> recorded_wire(const HeadData& line, std::uint8_t node);
/// The line in a recorded frame; nullopt if the frame does not contain a line.
std::optional<HeadData> recorded_line(std::span<const std::uint8_t> wire);

/// Differences between `asked` and the line that is sent instead, except rounding on the wire and in logs.
std::vector<Difference> differences(const HeadCommand& asked, const PingJob& sent, const HeadData& recorded);

}  // namespace sonard::micron
