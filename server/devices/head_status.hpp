// SPDX-License-Identifier: Apache-2.0
// Status of a head, for people and monitors.
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

/// A client that has sent something to a head.
struct ClientSeen {
  Endpoint address;          ///< default: any client of a shared serial line
  TimePoint last{};          ///< arrival of the newest piece
  std::uint64_t pieces = 0;  ///< datagrams, or reads of a stream
};

/// The newest ping that a head has requested.
struct NewestPing {
  std::vector<Setting> settings;  ///< set by the client
  double range_m = 0.0;
  double bearing_rad = 0.0;                   ///< PingJob::bearing_rad
  std::optional<render::Pose> T_world_mount;  ///< nullopt: not known
  double azimuth_rad = 0.0;                   ///< from the first edge of its beams to the last
  double elevation_rad = 0.0;                 ///< of the rendered fan
};

/// State of one head at one moment.
struct HeadStatus {
  std::string name;
  std::string type;  ///< as in the configuration
  bool scanning = false;
  std::vector<std::string> serves;  ///< Transport::descriptions()
  std::string link_faults;          ///< Transport::faults()
  std::vector<ClientSeen> clients;  ///< active in the last minute
  HeadCounts counts;
  double pings_per_s = 0.0;  ///< over the last five seconds
  std::optional<NewestPing> newest;
  render::StageSeconds spent;  ///< on the newest rendered ping
  /// From transmission to sending, of the newest ping.
  std::optional<std::chrono::nanoseconds> latency;
  std::optional<std::chrono::nanoseconds> since_last_ping;  ///< since the newest was sent; nullopt: no ping
  std::vector<Finding> findings;                            ///< about its place in the world
};

}  // namespace sonard::server
