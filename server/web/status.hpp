// SPDX-License-Identifier: Apache-2.0
// Status of the daemon, for people and monitors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"
#include "server/devices/head_status.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/pose/pose_config.hpp"
#include "server/pose/pose_history.hpp"
#include "server/pose/pose_source.hpp"
#include "server/pose/pose_statistics.hpp"
#include "server/pose/posed_body.hpp"
#include "server/recording/recorder.hpp"

namespace sonard::server {

/// Constant properties of a running daemon.
struct DaemonIdentity {
  std::string configuration;  ///< the file
  std::string world;
  std::optional<double> water_surface_z_m;
};

struct PoseInputStatus {
  std::string input;                     ///< PoseSource::description()
  std::optional<PublisherId> publisher;  ///< PoseSource::publisher()
  PoseStatistics::Summary poses;
  PoseSourceCounters counters;
  std::vector<Finding> findings;  ///< about this input
};

struct RecordingStatus {
  std::string directory;
  bool on = true;
  RecorderCounters counters;
};

/// Status of the daemon at one moment.
struct DaemonStatus {
  TimePoint at{};
  std::string engine;  ///< currently in use, one line
  std::vector<HeadStatus> heads;
  std::vector<PoseInputStatus> inputs;
  PingClock ping_clock = PingClock::wall;
  std::optional<render::Pose> T_world_vehicle;
  std::optional<StalePose> stale_pose;  ///< why there is no T_world_vehicle, if poses have arrived
  std::vector<PosedBody> bodies;
  std::optional<RecordingStatus> recording;
};

}  // namespace sonard::server
