// SPDX-License-Identifier: Apache-2.0
// The Ping360 as the server knows it.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& ping360_kind();

}  // namespace sonard::server
