// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Ping1D or Ping2, as plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "protocol/ping/clients.hpp"
#include "protocol/ping1d/messages.hpp"

namespace sonard::ping1d {

/// Section numbers refer to protocol/ping1d/README.md. The Device constructor rejects values out of range.
/// `idle_timeout` ends the stream of a client that listens without sending (3.5).
struct DeviceConfig : ClientsConfig {
  DeviceConfig() {
    idle_timeout = std::chrono::seconds{30};
    max_payload = 64;  // known commands have 8 bytes at most
  }

  std::uint8_t id = default_device_id;  ///< 0..254, until a client sets another
  /// A device_revision of 1 is a Ping1D, 2 a Ping2 (2.1). Clients expect a firmware above 3.26.
  DeviceInformation information{1, 1, 3, 29, 0};

  /// True speed of sound at the head; > 0. The head converts times with the speed that clients set.
  double water_sound_speed_mps = 1500.0;
  double least_range_m = 0.5;    ///< nearer echoes are hidden by the ringing transducer, >= 0 (3.4)
  int points = 200;              ///< of a profile, 10..1000 (2.4)
  double pulse_us_per_m = 26.0;  ///< transmit duration per metre of the scan, > 0 (3.4)

  // At boot (3).
  std::uint32_t scan_length_mm = 5000;  ///< 1000..most_range_mm
  std::uint16_t interval_ms = 250;
  std::uint8_t gain_setting = 1;  ///< 0..6

  // Auto mode (3.3).
  std::vector<double> auto_lengths_m{1, 2, 5, 10, 20, 30, 50, 70, 100};  ///< rising, 1..100; not empty
  double auto_target = 0.7;  ///< share of the length at which the target is wanted, 0.5..0.8

  int confidence_window = 5;                           ///< pings in the mean of the confidence, 1..100 (3.4)
  std::chrono::nanoseconds ping_overhead{10'000'000};  ///< beside listening, >= 0 (3.4)
  double time_scale =
      1.0;  ///< factor on the time from ping to ping, 0..1000; 0: as fast as pings are rendered
  std::chrono::nanoseconds bootloader_silence{std::chrono::seconds{5}};  ///< >= 0 (3.6)

  std::uint16_t voltage_mv = 5021;
  std::uint16_t processor_temperature_cdeg = 3725;  ///< 0.01 degrees C
  std::uint16_t pcb_temperature_cdeg = 3412;        ///< 0.01 degrees C

  bool accepts_any_destination = false;   ///< also frames to ids other than its own, 0 and 255 (1)
  bool acknowledges = true;               ///< sends an ack for each command that it obeys (3.2)
  bool refuses_silently_in_auto = false;  ///< no nack for range and gain in auto mode (3.3)

  /// The head sends only the pings that it is fed (PingFed).
  bool plays_back = false;
  /// A ping begins at NextPingDue if it is wanted, and is sent when it is rendered. The server observes
  /// NextPing.
  bool simulated_time = false;
};

inline constexpr std::uint32_t least_length_mm = 1000;
inline constexpr std::uint32_t most_range_mm = 120'000;  ///< end of a scan
inline constexpr std::uint8_t most_gain = 6;
inline constexpr double carrier_hz = 115e3;

}  // namespace sonard::ping1d
