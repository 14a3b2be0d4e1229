// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_source.hpp"

#include "server/pose/gazebo_pose_source.hpp"
#include "server/pose/mavlink_pose_source.hpp"
#include "server/pose/tcp_pose_source.hpp"
#include "server/pose/trajectory_pose_source.hpp"
#include "server/pose/udp_pose_source.hpp"

namespace sonard::server {

std::vector<std::unique_ptr<PoseSource>> make_pose_sources(boost::asio::io_context& io,
                                                           const PoseConfig& config, const Clock& clock,
                                                           const std::function<PoseSink()>& sink_of_next,
                                                           const PoseHold& hold) {
  std::vector<std::unique_ptr<PoseSource>> sources;
  if (config.udp) {
    sources.push_back(std::make_unique<UdpPoseSource>(io, *config.udp, clock, sink_of_next()));
  }
  if (config.tcp) {
    sources.push_back(std::make_unique<TcpPoseSource>(io, *config.tcp, clock, sink_of_next(), hold));
  }
  if (config.mavlink) {
    sources.push_back(std::make_unique<MavlinkPoseSource>(io, *config.mavlink, clock, sink_of_next()));
  }
  if (config.gazebo) {
#ifdef SONARD_HAS_GAZEBO
    sources.push_back(std::make_unique<GazeboPoseSource>(io, *config.gazebo, clock, sink_of_next()));
#else
    throw PoseSourceError("this sonard was built without Gazebo Transport");
#endif
  }
  if (config.trajectory) {
    sources.push_back(std::make_unique<TrajectoryPoseSource>(io, *config.trajectory, clock, sink_of_next()));
  }
  return sources;
}

}  // namespace sonard::server
