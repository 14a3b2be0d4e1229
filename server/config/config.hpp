// SPDX-License-Identifier: Apache-2.0
// The whole configuration of the daemon as plain values: SI units, radians, parsed addresses, paths resolved
// against the folder of the configuration file. Each room has its own part of it.
// server/config/loader.hpp makes it from YAML; the rest of the server only reads it.
// docs/configuration.md lists the keys with their units and defaults.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "renderer/renderer_options.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "renderer/skip_ledger.hpp"
#include "server/heads/head_config.hpp"
#include "server/heads/water_config.hpp"
#include "server/pose/pose_config.hpp"
#include "server/recording/recording_config.hpp"
#include "server/web/web_config.hpp"

namespace sonard::server {

enum class LogLevel { trace, debug, info, warn, error };
enum class LogFormat { text, json };

/// The program's log.
struct LogConfig {
  LogLevel level = LogLevel::info;
  LogFormat format = LogFormat::text;
};

/// The world around the heads.
struct WorldConfig {
  std::filesystem::path file;  ///< SDF; empty: open water, see `open_water`
  bool open_water = false;     ///< whether the world may be without a surface
  bool skips_missing_files = false;
  int max_triangles = 50'000'000;
  /// The world's place on Earth; replaces the place in the world file.
  std::optional<render::GeographicOrigin> origin;
  /// The body of the world that is the vehicle and moves with it. If empty: no body, or the one with the
  /// sonars that give the mounts of the heads (resolve_mounts() sets it).
  std::string vehicle_model;
};

struct DaemonConfig {
  std::filesystem::path file;  ///< the configuration file itself
  LogConfig log;
  WorldConfig world;
  render::EngineKind engine = render::EngineKind::automatic;
  render::GpuOptions gpu;
  render::SkipSwitches skip;  ///< what the renderer may leave out (docs/skipping.md)
  WaterConfig water;
  PoseConfig poses;
  std::vector<HeadConfig> heads;  ///< at least one
  std::optional<RecordingConfig> recording;
  std::optional<WebConfig> web;  ///< nullopt: no page
};

}  // namespace sonard::server
