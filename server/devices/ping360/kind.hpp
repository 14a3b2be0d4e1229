// SPDX-License-Identifier: Apache-2.0
// The kind of device of the Ping360.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& ping360_kind();

}  // namespace sonard::server
