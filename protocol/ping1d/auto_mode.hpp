// SPDX-License-Identifier: Apache-2.0
// Range and gain that the head chooses in auto mode. Source: protocol/ping1d/README.md 3.3.
#pragma once

#include "protocol/ping1d/device_config.hpp"
#include "protocol/ping1d/echo.hpp"
#include "protocol/ping1d/scan.hpp"

namespace sonard::ping1d {

/// The scan of the next ping: at most one step of length and one of gain from `scan`, whose ping showed
/// `echo`.
Scan next_auto_scan(const Scan& scan, const Echo& echo, const DeviceConfig& config);

}  // namespace sonard::ping1d
