// SPDX-License-Identifier: Apache-2.0
// An item of the section `heads` of the configuration.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "renderer/pose.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::server {

class HeadType;

/// The part of a head's configuration that only its type of device reads.
struct DeviceSettings {
  DeviceSettings() = default;
  virtual ~DeviceSettings() = default;
  DeviceSettings(const DeviceSettings&) = default;
  DeviceSettings& operator=(const DeviceSettings&) = default;
};

/// One head.
struct HeadConfig {
  const HeadType* type = nullptr;                ///< type of device; not null after loading
  std::shared_ptr<const DeviceSettings> device;  ///< of that type
  std::string name;              ///< unique in the daemon; appears in every log line of this head
  render::Pose T_vehicle_sonar;  ///< mount
  /// The sonar of the world that gives the mount (resolve_mounts() reads it); empty: no such sonar.
  std::string mount_from_world;
  bool hides_vehicle = false;  ///< whether its images leave out WorldConfig::vehicle_model
  /// All values of a ping that the device itself does not set.
  render::SonarSettings acoustics;
  /// Whether a faster preset than the one of `acoustics` is used while pings cannot be made at the requested
  /// rate.
  bool adaptive_quality = false;
  std::uint64_t seed = 1;  ///< of speckle and noise
  /// Folder for the samples of every ping as the renderer returned them, for tests and debugging.
  std::optional<std::filesystem::path> dump_directory;
};

}  // namespace sonard::server
