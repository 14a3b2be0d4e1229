// What a ping configuration makes the head do (docs/protocols/gemini.md 5, 6.2, 6.7).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/messages.hpp"
#include "protocol/gemini/ping_job.hpp"

namespace sonard::gemini {

/// A ping configuration understood: what is the same for every ping made from it.
struct PingPlan {
  RunMode mode = RunMode::single;
  bool pings_out_of_water = false;
  std::chrono::nanoseconds interval{};  ///< start to start, in continuous mode
  PingJob job;                          ///< lacks the number and the transmit time
  PingHead head;                        ///< lacks the ping ID and the transmit time
  std::uint16_t line_scale = 0;         ///< PingLine::scale

  /// Time until the echo of the last native line is back.
  std::chrono::nanoseconds listening_time() const;
};

/// Time from the transmit pulse until `native_lines` lines have been received, rounded up.
std::chrono::nanoseconds acoustic_time(int native_lines);

/// nullopt when the head cannot do it: I/Q or channel data, whose layouts are undocumented, or the reserved
/// run mode.
///
/// Limits of a head that stands for the real one: fewer than 32 native lines count as 32, more than the
/// libraries ever ask for (20000 of 8 bit, 10000 of 16 bit) as that; the ping head then reports what is
/// really sent, so that the surface expects the right number. Speeds of sound outside 1400..1588.8 m/s are
/// moved inside. Everything not named in PingPlan has no effect on a 720i or on this model of it.
std::optional<PingPlan> plan_ping(const PingConfig& config, const DeviceConfig& device);

/// What a head does about `asked` that has only this recorded ping to offer. A ping with a time of its own
/// keeps it: the interval asked for does not matter.
PingPlan held_to(const RecordedPing& recorded, const PingPlan& asked, const DeviceConfig& device);

}  // namespace sonard::gemini
