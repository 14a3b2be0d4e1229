// SPDX-License-Identifier: Apache-2.0
// Foxglove messages of a ping: an image, the pose of the sonar, and echoes as points. Sonar axes are as in
// REP-103: x forward, y to port, z up.
#pragma once

#include <cstdint>
#include <string>

#include "protocol/common/ping_record.hpp"
#include "protocol/log/foxglove.pb.h"
#include "renderer/pose.hpp"

namespace sonard::server {

/// @param jpeg image of the ping
foxglove::CompressedImage foxglove_image(std::string jpeg, const std::string& head, std::int64_t time_ns);

/// Transform from "world" to the head.
foxglove::FrameTransform foxglove_transform(const render::Pose& T_world_sonar, const std::string& head,
                                            std::int64_t time_ns);

/// The echoes of a head that measures directions, the strongest echo of each beam of another multibeam head,
/// or every bin of the line of a scanning head. Points are x, y, z of the centre of a bin, in metres, and
/// `intensity`, the sample: four 32-bit floats.
foxglove::PointCloud foxglove_echoes(const PingRecord& ping, const std::string& head, std::int64_t time_ns);

}  // namespace sonard::server
