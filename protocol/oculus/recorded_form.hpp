// SPDX-License-Identifier: Apache-2.0
// A ping of an Oculus as logs keep it, and back: what goes to a log, and how a head sends what comes from
// one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/oculus/ping_plan.hpp"

namespace sonard::oculus {

/// The record of a ping that leaves as `message`, whose image it views. Of samples of more than 8 bits the
/// high ones are kept; `wire` ends where the bearings do. Number, time and gain are left out.
PingRecord record_of(const PingResult& ping, std::span<const std::uint8_t> message);

/// The ping that PingRecord::wire tells of, without its image; nullopt where it tells of none that a head
/// could send: of 256 or 512 beams, with rows.
std::optional<PingResult> recorded_form(std::span<const std::uint8_t> wire);

/// What a head does about `asked` that has only this recorded ping to send: its rows, beams, bearings and
/// frequency, in the form that the client asks for, whose samples have 8 bits of meaning. The client finds
/// the settings that it has sent, but for the flag of the beams. Requires a recorded_form().
PingPlan held_to(const RecordedPing& recorded, const PingPlan& asked);

/// How `asked` differs from what is sent in its place. Rounding is no difference.
std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded);

}  // namespace sonard::oculus
