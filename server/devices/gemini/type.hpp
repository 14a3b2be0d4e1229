// SPDX-License-Identifier: Apache-2.0
// The type of device of the Gemini 720i.
#pragma once

#include "server/devices/device_type.hpp"

namespace sonard::server {

const DeviceType& gemini_type();

}  // namespace sonard::server
