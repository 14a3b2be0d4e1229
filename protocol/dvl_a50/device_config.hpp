// SPDX-License-Identifier: Apache-2.0
// All settings of a simulated DVL, as plain values.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include "protocol/dvl_a50/messages.hpp"
#include "protocol/dvl_a50/range_mode.hpp"
#include "protocol/dvl_a50/release.hpp"

namespace sonard::dvl_a50 {

enum class Model { a50, a125 };

/// Section numbers refer to protocol/dvl_a50/README.md. The Device constructor rejects values out of range.
struct DeviceConfig {
  /// A device of this model, of the newest release.
  explicit DeviceConfig(Model used_model = Model::a50) : model(used_model) {
    if (model == Model::a125) {
      range_modes[4].most_m = 125.0;
      product_id = 21037;
      product_name = "DVL A125";
      serial_name = "dvl-a125";
      most_speed_mps = 9.0;
    }
  }

  // Channels beside that of the JSON clients, which is 0; below 0: none.
  int pd6_channel = -1, pd4_channel = -1, http_channel = -1, serial_channel = -1;

  Model model;
  Release release = Release::v2_7_2;
  std::string line_end = "\r\n";  ///< of JSON messages
  Settings settings{};            ///< at power up, in range
  int serial_output = 1;          ///< of the command wcp at power up: 0, 1, 2, 3 or 6 (6)

  // Identity (2).
  int product_id = 21035;
  std::string product_name = "DVL A50";
  std::string serial_name = "dvl-a50";
  std::string chip_id = "0xf1440c09140b04";
  double temperature_c = 30.0;  ///< from 55 on, bit 0 of the status is set

  // The measurement (4).
  double water_sound_speed_mps = 1475.0;  ///< true speed; > 0
  double most_speed_mps = 3.75;           ///< a faster device has no bottom lock; > 0
  double most_water_speed_mps = 7.5;      ///< > 0
  double beam_noise_mps = 1e-4;           ///< standard deviation of a beam's velocity at rest, >= 0
  double beam_noise_factor = 1e-3;        ///< added to it, times the speed; >= 0
  double invalid_fom_mps = 2.707;
  double rssi_at_half_metre_dbm = -30.0;
  double nsd_dbm = -95.0;
  double altitude_offset_m = -0.015;
  double distance_steps_hz = 125'000.0;  ///< distances are multiples of sound speed by this; > 0
  Vector water_current_mps{};            ///< of the water in the world (east, north, up)
  double heading_drift_deg_per_min = 0.2;
  double position_noise_m = 0.005;  ///< DeadReckoningConfig::noise_m; >= 0
  std::uint64_t seed = 1;

  // Time (5).
  RangeModes range_modes{
      {{0.05, 0.6, 15.0}, {0.3, 3.0, 10.0}, {1.5, 14.0, 5.3}, {7.7, 36.0, 7.5}, {15.0, 50.0, 3.0}}};
  double water_rate_hz = 2.0;  ///< > 0
  double time_scale = 1.0;     ///< factor on the time from ping to ping and on calibration_time, 0..1000
  std::chrono::nanoseconds search_interval{1'100'000'000};    ///< of reports without bottom lock, > 0
  std::chrono::nanoseconds cycling_interval{10'000'000'000};  ///< of periodic cycling, > 0
  std::chrono::nanoseconds processing_delay{150'000'000};     ///< from the reflection to the report, >= 0
  std::chrono::nanoseconds calibration_time{3'000'000'000};   ///< >= 0
  std::chrono::nanoseconds unix_offset{0};  ///< from the clock of Device::step() to the time since 1970
  bool ntp_synced = false;                  ///< a time server can be reached

  /// The device sends only the pings that it is fed (PingFed).
  bool plays_back = false;
  /// A ping begins at NextPingDue, and is sent when it is rendered. The server observes NextPing.
  bool simulated_time = false;
};

inline constexpr int json_channel = 0;

/// @return `config` @throws std::invalid_argument naming the field that is out of range
const DeviceConfig& validated(const DeviceConfig& config);

}  // namespace sonard::dvl_a50
