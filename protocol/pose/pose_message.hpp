// SPDX-License-Identifier: Apache-2.0
// Transforms in messages that hold a sonard.pose.Pose. For codecs only: it brings in the generated code.
#pragma once

#include "protocol/pose/pose.pb.h"
#include "protocol/pose/transform.hpp"

namespace sonard::pose {

void write(const Transform& transform, Pose& message);
/// Checked and scaled as normalize() does; on a fault `transform` is no rotation.
TransformFault read(const Pose& message, Transform& transform);

}  // namespace sonard::pose
