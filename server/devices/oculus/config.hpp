// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `oculus` has (docs/configuration.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "protocol/oculus/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/addresses.hpp"
#include "server/yaml/status_destination.hpp"

namespace sonard::server {

/// Values that change with the head's frequency. The horizontal aperture is in the model of the device.
struct OculusModeAcoustics {
  double vertical_beamwidth_rad = 0.0;
  double receive_beamwidth_rad = 0.0;
  double range_cell_m = 0.0;  ///< c / 2B of the chirp
  double absorption_db_per_m = 0.0;
  double wavelength_m = 0.0;
  double noise_db = 0.0;  ///< noise above NoiseSettings::level_db
};

/// The head's x axis is the acoustic axis, so the mount includes any down tilt. Its jobs set the beams,
/// `range`, the values in `modes`, and the output scale.
struct OculusConfig final : DeviceSettings {
  /// Identity, model and timing; its sockets use the same address.
  oculus::DeviceConfig device;
  std::uint16_t tcp_port = 52100;
  std::uint16_t status_port = 52102;  ///< destination port of status packets
  /// Interfaces that give, and keep updating, the address and the mask; empty: given as numbers.
  std::string interface, netmask_interface;
  StatusDestination status;
  AllowList allow;                           ///< clients that are served; does not affect status packets
  std::array<OculusModeAcoustics, 2> modes;  ///< low frequency, high frequency
  double gain_db_per_percent = 0.6;          ///< 50 percent is 0 dB
};

/// Default acoustics of such a head.
render::SonarSettings oculus_acoustics();
/// The beams and pulses of a model, from data sheets, and the absorption in default water.
std::array<OculusModeAcoustics, 2> oculus_modes(const oculus::Model& model);

}  // namespace sonard::server
