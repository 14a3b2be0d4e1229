// SPDX-License-Identifier: Apache-2.0
// The Gemini 720i as the server knows it.
#pragma once

#include "server/devices/device_kind.hpp"

namespace sonard::server {

const DeviceKind& gemini_kind();

}  // namespace sonard::server
