// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated Sonar 3D-15, as plain values.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <optional>

#include "protocol/common/endpoint.hpp"
#include "protocol/sonar3d15/packet.hpp"

namespace sonard::sonar3d15 {

/// Version of the software in the head: selects the paths of the HTTP interface, the packets and the status
/// (9).
struct Release {
  int major = 0, minor = 0, patch = 0;  ///< >= 0

  auto operator<=>(const Release&) const = default;
};

/// One of the two frequencies (3).
struct ModeConfig {
  double rate_hz = 0.0;                ///< shots per second, > 0
  std::chrono::nanoseconds latency{};  ///< from the pulse to the datagrams, >= 0
  double horizontal_fov_deg = 0.0;     ///< > 0, at most 160
  double vertical_fov_deg = 0.0;       ///< > 0, at most 160
  double carrier_hz = 0.0;             ///< > 0
  std::uint32_t frequency_field = 0;   ///< field `frequency` of the images (2.2)
};

enum class UdpMode : std::uint8_t { multicast, unicast, disabled };

inline constexpr Endpoint multicast_group{0xE0000060, 4747};  ///< 224.0.0.96 (6)

/// Section numbers refer to protocol/sonar3d15/README.md. The Device constructor rejects values out of range.
struct DeviceConfig {
  Release release{1, 8, 0};
  std::optional<PacketId> packets;  ///< nullopt: by the release

  // At start (7).
  UdpMode udp_mode = UdpMode::multicast;
  Endpoint unicast;  ///< for UdpMode::unicast: an address and a port, not 0
  bool acoustics = false;
  double least_range_m = 0.3;        ///< >= 0
  double range_m = 15.0;             ///< above least_range_m, at most most_range_m
  std::uint32_t first_sequence = 0;  ///< number of the first shot

  double most_range_m = 16.0;  ///< that a client may set; at most 50
  int columns = 256;           ///< >= 2; both images fit a datagram up to 20000 pixels
  int rows = 64;               ///< >= 2
  ModeConfig low{5.0, std::chrono::milliseconds{50}, 90.0, 40.0, 1.2e6, 5};
  ModeConfig high{20.0, std::chrono::milliseconds{20}, 40.0, 40.0, 2.4e6, 20};
  double time_scale =
      1.0;  ///< factor on the time from shot to shot, 0..1000; 0: as fast as shots are rendered

  // Numbers of the images (4).
  double pixel_scale_m = 50.0 / 65536.0;  ///< range of one unit, > 0
  double range_step_s = 1e-6;             ///< one-way time of a range step, > 0
  double gain = 1e6;          ///< from the amplitude re the source at 1 m to the linear strength, > 0
  double threshold = 30.0;    ///< weaker echoes are not sent; linear strength, >= 30
  double range_bin_m = 0.01;  ///< of the renderer: half the range resolution, > 0

  double water_sound_speed_mps = 1500.0;      ///< true speed at the head, > 0
  double automatic_sound_speed_mps = 1491.0;  ///< that the head assumes if a client sets 0, > 0 (7)
  double temperature_c = 31.5;                ///< inside; from 60 on, acoustics stay off (5.2)

  /// UTC since 1970, minus the clock of Device::step(): of the clock in the head, when it is synchronised.
  std::chrono::nanoseconds utc_offset{};
  bool ntp_synced = true;  ///< false: no time server answers, and a client may set the time (5)
  /// Without a time server: how much the head's clock is ahead until a client sets it.
  std::chrono::nanoseconds clock_offset{};
  std::chrono::nanoseconds
      speed_change_time{};  ///< >= 0; until shots have a speed of sound that a client set

  bool sends_shaded = false;  ///< a third image of each shot (2.3)

  // Motion sensor (2.4).
  double imu_force_noise_mps2 = 0.0, imu_rate_noise_radps = 0.0;  ///< standard deviations, >= 0
  int imu_batch_samples = 0;                                      ///< of a batch; 0: those of one shot
  std::uint64_t seed = 0;                                         ///< of the noise

  /// A shot begins at NextPingDue if acoustics are on, and is sent when it is rendered.
  bool simulated_time = false;
  bool plays_back = false;  ///< sends only the recorded shots that it is fed (PingFed)

  const ModeConfig& mode(bool high_frequency) const { return high_frequency ? high : low; }
};

}  // namespace sonard::sonar3d15
