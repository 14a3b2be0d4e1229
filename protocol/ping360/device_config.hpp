// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Ping360, as plain values.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "protocol/ping/clients.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// Section numbers refer to protocol/ping360/README.md. The Device constructor rejects values out of range.
/// `idle_timeout` also ends the scan of its client. It is 0, as on a real head, because clients may listen
/// for a whole turn of 38 s without sending (3.3).
struct DeviceConfig : ClientsConfig {
  std::uint8_t id = default_device_id;  ///< 1..254, until a client sets another (1, 3.6)
  /// The device_revision must not be 0 (2.1). Up to firmware 3.3.0 a known viewer scans with `transducer`
  /// (6).
  DeviceInformation information{2, 1, 3, 3, 8};

  /// True speed of sound at the head, used to convert times to ranges; > 0 (2.3).
  double water_sound_speed_mps = 1500.0;
  std::array<double, 3> gain_db{0.0, 6.0, 12.0};  ///< for the gain settings low, normal and high (2.3)
  int bearing_offset = 0;                         ///< angle that is straight ahead, gradians, 0..399 (6)

  std::chrono::nanoseconds ping_overhead{18'000'000};    ///< added to listening and turning, >= 0 (3.7)
  std::chrono::nanoseconds time_per_gradian{6'100'000};  ///< turning time, >= 0 (3.7)
  /// Factor on all times from ping to ping, 0..1000; 0: as fast as pings are rendered (3.7).
  double time_scale = 1.0;

  std::chrono::nanoseconds reset_silence{std::chrono::seconds{1}};       ///< >= 0 (3.5)
  std::chrono::nanoseconds bootloader_silence{std::chrono::seconds{5}};  ///< >= 0 (3.5)

  /// A transducer command that repeats the client's last unanswered one shares its answer (3.2).
  bool joins_repeated_commands = true;
  /// Maximum number of waiting commands; beyond that the oldest waiting one is dropped (3.2).
  std::size_t queue_length = 4;
  bool accepts_angle_400 = true;            ///< as angle 0 (2.3)
  bool obeys_set_common_device_id = false;  ///< message 100 acts as 2000 (3.6)
  bool signed_scan_angles = false;          ///< scan limits are signed and never refused (2.3)
  bool clamps_scan_to_stop = false;         ///< a sector ends at its limit, not at the last whole step (3.3)
  bool ignores_other_destinations = false;  ///< ignore frames to other ids than its own, 0 and 255 (1)

  /// The head sends only the pings that it is fed (PingFed).
  bool plays_back = false;
  /// A ping begins at NextPingDue if it is wanted, and is sent when it is rendered. The server observes
  /// NextPing.
  bool simulated_time = false;
};

}  // namespace sonard::ping360
