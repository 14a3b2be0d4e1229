// SPDX-License-Identifier: Apache-2.0
// How a head does, for people and their monitors.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/ping_job.hpp"
#include "renderer/ping.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"
#include "server/devices/head_log.hpp"
#include "server/diagnosis/finding.hpp"

namespace sonard::server {

/// Somebody who has sent something to a head.
struct ClientSeen {
  Endpoint address;          ///< the default: whoever is on a line that all clients share
  TimePoint last{};          ///< when the newest piece came
  std::uint64_t pieces = 0;  ///< datagrams, or pieces of a stream
};

/// The newest ping that a head has asked for.
struct NewestPing {
  std::vector<Setting> settings;  ///< by the client
  double range_m = 0.0;
  double bearing_rad = 0.0;                   ///< PingJob::bearing_rad
  std::optional<render::Pose> T_world_mount;  ///< nullopt: not known
  double azimuth_rad = 0.0;                   ///< from the first edge of its beams to the last
  double elevation_rad = 0.0;                 ///< of the rendered fan
};

/// One head at one moment.
struct HeadStatus {
  std::string name;
  std::string kind;  ///< as in the configuration
  bool scanning = false;
  std::vector<std::string> serves;  ///< Transport::descriptions()
  std::string link_faults;          ///< Transport::faults()
  std::vector<ClientSeen> clients;  ///< of the last minute
  HeadCounts counts;
  double pings_per_s = 0.0;  ///< over the last five seconds
  std::optional<NewestPing> newest;
  render::PingStatistics spent;  ///< on the newest ping that was rendered
  /// From its transmission to when the newest ping went out.
  std::optional<std::chrono::nanoseconds> latency;
  std::optional<std::chrono::nanoseconds> since_last_ping;  ///< that went out; nullopt: none did
  std::vector<Finding> findings;                            ///< what looks wrong about its place in the world
};

}  // namespace sonard::server
