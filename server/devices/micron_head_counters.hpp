// What a Micron has done, device and transport together.
#pragma once

#include "protocol/micron/device_counters.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/devices/serial/serial_link.hpp"

namespace sonard::server {

/// They only grow.
struct MicronHeadCounters : RenderCounters {
  micron::DeviceCounters device;
  SerialLinkCounters link;
};

}  // namespace sonard::server
