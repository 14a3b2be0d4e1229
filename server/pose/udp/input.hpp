// SPDX-License-Identifier: Apache-2.0
// The section `poses.udp`: pose messages by UDP.
#pragma once

#include <memory>

#include "server/net/addresses.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// A UDP socket that receives one pose message per datagram (docs/poses.md).
struct UdpPoseInput {
  Endpoint bind;
  AllowList allow;
};

std::shared_ptr<const PoseInput> pose_input(UdpPoseInput settings);

const PoseSourceType& udp_pose_source_type();

}  // namespace sonard::server
