// SPDX-License-Identifier: Apache-2.0
// What only a head of type `oculus` has in the configuration (docs/configuration.md).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "protocol/oculus/device_config.hpp"
#include "server/config/config.hpp"
#include "server/config/status_destination.hpp"

namespace sonard::server {

/// What changes where the head changes its frequency. Its horizontal aperture is in the model of the device.
struct OculusModeAcoustics {
  double vertical_beamwidth_rad = 0.0;
  double receive_beamwidth_rad = 0.0;
  double range_cell_m = 0.0;  ///< c / 2B of its chirp
  double absorption_db_per_m = 0.0;
  double wavelength_m = 0.0;
  double noise_db = 0.0;  ///< by how much noise is above PhysicalModel::noise_level_db
};

/// The head's x axis is the acoustic axis, so a down tilt is in the mount. Its jobs fill in the beams,
/// `range`, what is in `modes`, and the output scale.
struct OculusConfig final : DeviceSettings {
  /// Identity, model and timing; its address is also that of its sockets.
  oculus::DeviceConfig device;
  std::uint16_t tcp_port = 52100;
  std::uint16_t status_port = 52102;  ///< that status packets go to
  /// By whose name the address and the mask are given, and followed; empty: as numbers.
  std::string interface, netmask_interface;
  StatusDestination status;
  AllowList allow;                           ///< clients that are served; status packets are not affected
  std::array<OculusModeAcoustics, 2> modes;  ///< low frequency, high frequency
  double gain_db_per_percent = 0.6;          ///< 50 percent are 0 dB
};

/// Of a head of this type.
inline const OculusConfig& oculus_config(const HeadConfig& head) {
  return static_cast<const OculusConfig&>(*head.device);
}

/// The acoustics of such a head, where nothing is configured.
render::SonarSettings oculus_acoustics();
/// The beams and pulses of a model, as data sheets have them, without what the water does to its sound.
std::array<OculusModeAcoustics, 2> oculus_modes(const oculus::Model& model);

}  // namespace sonard::server
