// SPDX-License-Identifier: Apache-2.0
// The type of device of the Micron.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& micron_type();

}  // namespace sonard::server
