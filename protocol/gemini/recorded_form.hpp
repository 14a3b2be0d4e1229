// SPDX-License-Identifier: Apache-2.0
// Conversion of a 720i's pings to log records and back.
#pragma once

#include <optional>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/gemini/ping_plan.hpp"

namespace sonard::gemini {

/// The record of an image that is sent with the complete `head`, without number, time and gain. Samples are
/// as a client has them after decoding: zero below the run-length threshold, and the high byte of 16 bits.
PingRecord record_of(const PingHead& head, const PingImage& image);

/// The settings in a ping head, which does not contain the gain.
RecordedSettings settings_of(const PingHead& head);

/// How a 720i sends an image of given settings. A 720i has fixed line steps. `exact` is true if the step of
/// the recording is one of them; otherwise ranges are wrong on the wire.
struct RecordedForm {
  int lines = 0;
  int compression_log2 = 0;
  bool exact = true;
};
/// nullopt if a 720i cannot send the image: not 256 beams, no lines, or too many lines.
std::optional<RecordedForm> recorded_form(const RecordedSettings& settings);

/// Changes the plan `asked` so that it sends this recorded ping. A ping with its own due time ignores the
/// requested interval. Requires a recorded_form().
PingPlan held_to(const ReplayedPing& recorded, const PingPlan& asked, const DeviceConfig& device);

/// Differences between `asked` and the ping that is sent instead, except rounding on the wire and in logs.
std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded);

}  // namespace sonard::gemini
