// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Oculus, as plain values.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include "protocol/common/endpoint.hpp"
#include "protocol/oculus/ping_plan.hpp"

namespace sonard::oculus {

/// Section numbers refer to protocol/oculus/README.md. The Device constructor rejects values out of range.
struct DeviceConfig {
  std::uint16_t id = 7892;    ///< not 0; used in the status and over TCP (1)
  Ipv4 address = 0x7F000001;  ///< clients connect to exactly this address; default 127.0.0.1 (6)
  Ipv4 netmask = 0xFFFFFF00;  ///< (6)
  std::array<std::uint8_t, 6> mac{0x00, 0x1E, 0x63, 0x01, 0x02, 0x03};
  PlanConfig plan;
  std::string log_text = "sonard Oculus\nready\n";                  ///< sent to each new client (5)
  std::chrono::nanoseconds status_period{std::chrono::seconds{1}};  ///< > 0 (6)
  std::chrono::nanoseconds dummy_period{std::chrono::seconds{1}};   ///< > 0 (5)
  bool simulated_time = false;                                      ///< each ping needs NextPingDue to begin
  bool plays_back = false;                                          ///< sends only recorded pings
};

}  // namespace sonard::oculus
