// SPDX-License-Identifier: Apache-2.0
// A ping of a 720i as logs keep it, and back: what goes to a log, and how a head sends what comes from one.
#pragma once

#include <optional>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/gemini/ping_plan.hpp"

namespace sonard::gemini {

/// The record of an image that leaves under `head`, which is complete. Samples are as a topside has them
/// after decoding: where beams below a threshold travel as zeros they are zeros, and of 16 bits the high ones
/// are kept. Number, time and gain are left out.
PingRecord record_of(const PingHead& head, const PingImage& image);

/// What a ping head says of its ping; the gain is not in it.
RecordedSettings settings_of(const PingHead& head);

/// How a 720i sends an image of these settings. Lines of a 720i have steps of its own; `exact` says whether
/// those of the recording are among them, or ranges will be wrong on the wire.
struct RecordedForm {
  int lines = 0;
  int compression_log2 = 0;
  bool exact = true;
};
/// nullopt where a 720i cannot send it: other than 256 beams, too many lines.
std::optional<RecordedForm> recorded_form(const RecordedSettings& settings);

/// What a head does about `asked` that has only this recorded ping to send. A ping with a time of its own
/// keeps it: the interval asked for does not matter. Requires a recorded_form().
PingPlan held_to(const RecordedPing& recorded, const PingPlan& asked, const DeviceConfig& device);

/// How `asked` differs from what is sent in its place. Rounding of the wire and of logs is no difference.
std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded);

}  // namespace sonard::gemini
