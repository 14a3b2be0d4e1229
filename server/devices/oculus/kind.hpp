// SPDX-License-Identifier: Apache-2.0
// The Oculus as the server knows it.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& oculus_kind();

}  // namespace sonard::server
