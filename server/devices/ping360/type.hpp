// SPDX-License-Identifier: Apache-2.0
// The type of device of the Ping360.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& ping360_type();

}  // namespace sonard::server
