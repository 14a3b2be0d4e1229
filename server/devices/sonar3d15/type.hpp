// SPDX-License-Identifier: Apache-2.0
// The type of device of the Sonar 3D-15.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& sonar3d15_type();

}  // namespace sonard::server
