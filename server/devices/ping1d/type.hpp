// SPDX-License-Identifier: Apache-2.0
// The type of device of the Ping1D and the Ping2.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& ping1d_type();

}  // namespace sonard::server
