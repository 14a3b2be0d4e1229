// SPDX-License-Identifier: Apache-2.0
// The type of device of the Oculus.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& oculus_type();

}  // namespace sonard::server
