// SPDX-License-Identifier: Apache-2.0
// Conversion between Transform and sonard.pose.Pose. For codecs only, because it includes the generated code.
#pragma once

#include "protocol/pose/pose.pb.h"
#include "protocol/pose/transform.hpp"

namespace sonard::pose {

void write(const Transform& transform, Pose& message);
/// Reads and checks a transform with normalize(). After a fault `transform` is invalid.
TransformFault read(const Pose& message, Transform& transform);

}  // namespace sonard::pose
