// SPDX-License-Identifier: Apache-2.0
// The section `poses.tcp`: pose messages by TCP.
#pragma once

#include <memory>

#include "server/net/addresses.hpp"
#include "server/pose/pose_input.hpp"

namespace sonard::server {

/// A TCP listener for varint-delimited pose messages (docs/poses.md).
struct TcpPoseInput {
  Endpoint bind;
  AllowList allow;
  int max_clients = 8;  ///< further connections are closed at once
};

std::shared_ptr<const PoseInput> pose_input(TcpPoseInput settings);

const PoseSourceType& tcp_pose_source_type();

}  // namespace sonard::server
