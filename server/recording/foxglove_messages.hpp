// SPDX-License-Identifier: Apache-2.0
// A ping as Foxglove shows it: a picture, the place of the sonar, and echoes as points. Axes of the sonar are
// those of REP-103: x forward, y to port, z up.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/common/ping_record.hpp"
#include "protocol/log/foxglove.pb.h"
#include "renderer/pose.hpp"

namespace sonard::server {

/// @param jpeg a picture of the ping
foxglove::CompressedImage foxglove_image(std::string jpeg, const std::string& head, std::int64_t time_ns);

/// From "world" to the head.
foxglove::FrameTransform foxglove_transform(const render::Pose& T_world_sonar, const std::string& head,
                                            std::int64_t time_ns);

/// Of a multibeam head the strongest echo of each beam; of a scanning head every bin of the line. Points are
/// x, y, z in metres and `intensity`, the sample, in four 32-bit floats; the middle of a bin stands for it.
foxglove::PointCloud foxglove_echoes(const PingRecord& ping, const std::string& head, std::int64_t time_ns);

}  // namespace sonard::server
