// What a head has done, device and transport together.
#pragma once

#include <cstdint>

#include "protocol/gemini/device_counters.hpp"
#include "renderer/skip_ledger.hpp"
#include "server/devices/faulty_link.hpp"
#include "server/devices/udp_endpoint.hpp"

namespace sonard::server {

/// They only grow; those of the socket begin anew when a reboot has moved the head to another address.
struct GeminiHeadCounters {
  gemini::DeviceCounters device;
  UdpEndpointCounters socket;
  FaultyLinkCounters to_surface;
  FaultyLinkCounters from_surface;
  std::uint64_t not_allowed = 0;         ///< datagrams from addresses outside `allow`
  std::uint64_t pings_without_pose = 0;  ///< not rendered: no pose, or a stale one under StalePolicy::silence
  std::uint64_t pings_rendered = 0;
  double render_seconds = 0.0;  ///< all of them together
  render::SkipCounts skipped;   ///< of all pings
};

}  // namespace sonard::server
