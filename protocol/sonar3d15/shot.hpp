// SPDX-License-Identifier: Apache-2.0
// The two images of a shot: from echoes to numbers, to log records and back. Source:
// protocol/sonar3d15/README.md 3, 4.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/directions.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/common/ping_record.hpp"
#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/controls.hpp"
#include "protocol/sonar3d15/device_config.hpp"

namespace sonard::sonar3d15 {

/// Range bins of a record. Logs keep a shot as a fan: the strongest signal of all rows in each bin and
/// column.
inline constexpr int fan_bins = 256;

struct Shot {
  RangeImage range;
  BitmapImageGreyscale8 signal;
};

/// The job of a shot with these settings, by a head that assumes this speed of sound.
PingJob make_job(const DeviceConfig& config, const Settings& settings, double sound_speed_mps);
/// Both images without echoes and header.
Shot make_shot(const DeviceConfig& config, const Settings& settings, double sound_speed_mps);

/// Fills both images. Ranges are those that a head measures with the speed of sound in the images. Echoes
/// outside of the range (`least_range_m` is its near end), weaker than the threshold or beyond 16 bits are 0
/// in both images. Returns false if the number of directions is not that of the images.
bool add_echoes(const DirectionRanges& echoes, const DeviceConfig& config, double least_range_m, Shot& shot);

/// Sets the header of both images: time since 1970, and number of the shot.
void set_header(std::chrono::nanoseconds utc, std::uint32_t sequence, Shot& shot);

/// The shaded image of a shot: how directly each surface faces the head, by the places of the echoes around
/// it, from 1 (along the direction) to 255.
BitmapImageGreyscale8 shaded(const Shot& shot);

/// Distance of a pixel along its direction; 0: no echo.
double distance_m(const RangeImage& image, int pixel);
/// Angle of a column about the head's vertical, positive to starboard. Column 0 is the port edge.
double column_rad(const RangeImage& image, int column);
/// Angle of a row above the horizontal plane of the head. Row 0 is the lowest.
double row_rad(const RangeImage& image, int row);

/// The record of a shot, without number and transmit time. Its PingRecord::wire must be both packets.
PingRecord record_of(const Shot& shot, double carrier_hz, std::vector<std::uint8_t> wire);
/// The shot in PingRecord::wire; nullopt if a head could not send it.
std::optional<Shot> recorded_form(std::span<const std::uint8_t> wire);
/// Differences of the recorded shot that is sent instead of `asked`.
std::vector<Difference> differences(const Shot& asked, const Shot& recorded);

}  // namespace sonard::sonar3d15
