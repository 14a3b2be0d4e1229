// SPDX-License-Identifier: Apache-2.0
// The kind of device of the Oculus.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& oculus_kind();

}  // namespace sonard::server
