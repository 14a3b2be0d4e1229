// SPDX-License-Identifier: Apache-2.0
// The Micron as the server knows it.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& micron_kind();

}  // namespace sonard::server
