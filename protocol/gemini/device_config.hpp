// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Gemini 720i, as plain values.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/gain_law.hpp"

namespace sonard::gemini {

/// Section numbers refer to protocol/gemini/README.md. The Device constructor rejects values out of range.
struct DeviceConfig {
  std::uint16_t sonar_id = 513;  ///< >= 2 (1.4)
  Ipv4 fixed_address = 0x0A3D13C8;
  Ipv4 alternate_address = 0;  ///< second reported address: non-zero, the client must reach it (1.2)
  Ipv4 netmask = 0xFFFFFF00;   ///< must be the real mask of the interface, or later clients stay silent
  std::array<std::uint8_t, 6> mac{0x00, 0x12, 0x34, 0x00, 0x02, 0x01};
  bool accept_id_zero = false;        ///< also accept commands with header ID 0
  std::uint16_t client_port = 52900;  ///< every reply goes to this port of the client (1.1)

  /// True speed of sound at the head, >= 0. 0: the speed of the ping configuration, so that the client's
  /// ranges are correct (6.7).
  double water_sound_speed_mps = 0.0;
  bool snap_sound_speed = false;  ///< report speeds on the device's grid: 3.2 m/s steps from 1400 m/s (5)
  GainLaw gain;

  std::chrono::nanoseconds status_period{std::chrono::seconds{1}};   ///< > 0 (1.3)
  std::chrono::nanoseconds min_ping_period{33'300'000};              ///< start to start, > 0 (8.4)
  std::chrono::nanoseconds client_timeout{std::chrono::seconds{3}};  ///< > 0 (1.5)
  std::chrono::nanoseconds reboot_time{std::chrono::seconds{5}};     ///< silence on reboot, >= 0 (3.9)
  /// While a client is connected, drop the commands of all other addresses (docs/security.md).
  bool lock_to_first = false;

  std::chrono::nanoseconds line_period{27'000};     ///< minimum mean time between ping datagrams, > 0 (8.5)
  int burst_lines = 32;                             ///< maximum ping datagrams sent back to back, 1..1024
  std::chrono::nanoseconds retry_hold{10'000'000};  ///< a new head waits this long after the last retry (7.3)
  std::chrono::nanoseconds retry_hold_max{50'000'000};  ///< but never longer than this

  /// How long before its transmit time a ping may be given out for rendering; >= 0. With 0 the pose is known.
  /// With more, the ping renders while the previous one is still being sent. This shortens the minimum ping
  /// period by as much, but the pose is a prediction.
  std::chrono::nanoseconds render_lead{0};

  /// The head sends only the pings that it is fed (PingFed).
  bool plays_back = false;
  /// A ping begins at NextPingDue, not at the head's own time. The server observes NextPing.
  bool simulated_time = false;
};

}  // namespace sonard::gemini
