// What a head has done, device and transport together.
#pragma once

#include <cstdint>

#include "protocol/gemini/device_counters.hpp"
#include "server/devices/faulty_link.hpp"
#include "server/devices/head_rendering.hpp"
#include "server/devices/udp_endpoint.hpp"

namespace sonard::server {

/// They only grow; those of the socket begin anew when a reboot has moved the head to another address.
struct GeminiHeadCounters : RenderCounters {
  gemini::DeviceCounters device;
  UdpEndpointCounters socket;
  FaultyLinkCounters to_surface;
  FaultyLinkCounters from_surface;
  std::uint64_t not_allowed = 0;  ///< datagrams from addresses outside `allow`
};

}  // namespace sonard::server
