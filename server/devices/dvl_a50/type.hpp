// SPDX-License-Identifier: Apache-2.0
// The type of device of the DVL A50 and A125.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& dvl_a50_type();

}  // namespace sonard::server
