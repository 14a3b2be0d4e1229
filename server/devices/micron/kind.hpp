// SPDX-License-Identifier: Apache-2.0
// The kind of device of the Micron.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& micron_kind();

}  // namespace sonard::server
