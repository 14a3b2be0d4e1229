// SPDX-License-Identifier: Apache-2.0
// The kind of device of the Gemini 720i.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& gemini_kind();

}  // namespace sonard::server
