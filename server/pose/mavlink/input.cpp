// SPDX-License-Identifier: Apache-2.0
#include "server/pose/mavlink/input.hpp"

#include <utility>

#include <fmt/format.h>

#include "server/pose/mavlink/source.hpp"
#include "server/yaml/network_section.hpp"
#include "server/yaml/pose_section.hpp"

namespace sonard::server {
namespace {

class MavlinkInput final : public PoseInputWith<MavlinkPoseInput> {
 public:
  explicit MavlinkInput(MavlinkPoseInput values)
      : PoseInputWith(mavlink_pose_source_type(), std::move(values)) {}

  std::string summary() const override {
    return fmt::format("MAVLink UDP {} (system {})", endpoint_text(settings.bind), settings.system_id);
  }
  std::optional<PlannedSocket> socket() const override {
    return PlannedSocket{PlannedSocket::Transport::udp, settings.bind, "poses.mavlink.bind"};
  }

  std::shared_ptr<const PoseInput> in_world(const WorldOfPoses& world,
                                            std::vector<ConfigProblem>& problems) const override {
    if (settings.messages == MavlinkMessages::global_position && !world.origin) {
      problems.push_back(
          {{},
           "poses.mavlink.messages",
           "global_position requires the position of the world on Earth (expected world.origin, or "
           "<spherical_coordinates> in its file)"});
    }
    MavlinkPoseInput placed = settings;
    placed.world_origin = world.origin;
    return pose_input(std::move(placed));
  }

  std::unique_ptr<PoseSource> open(boost::asio::io_context& io, const Clock& clock, PoseSink sink,
                                   PoseHold /*hold*/) const override {
    return std::make_unique<MavlinkPoseSource>(io, settings, clock, std::move(sink));
  }
};

std::shared_ptr<const PoseInput> read_mavlink(YamlSection& section, const std::filesystem::path& /*folder*/) {
  MavlinkPoseInput mavlink;
  read_socket(section, mavlink.bind, mavlink.allow, endpoint_form,
              "UDP address that receives the telemetry; the example uses 127.0.0.1:14660",
              "address blocks that may send telemetry");
  section.integer("system_id", mavlink.system_id, 1, 255,
                  "MAVLink system ID of the vehicle; sonard ignores messages from other systems");
  section.integer("component_id", mavlink.component_id, 1, 255,
                  "MAVLink component whose messages sonard uses; 1 is the autopilot");
  section.choice(
      "messages", mavlink.messages,
      {{"auto", MavlinkMessages::automatic},
       {"odometry", MavlinkMessages::odometry},
       {"local_position", MavlinkMessages::local_position},
       {"global_position", MavlinkMessages::global_position}},
      "messages that give the pose: ODOMETRY, or LOCAL_POSITION_NED or GLOBAL_POSITION_INT with "
      "the attitude. `auto` uses the first in this list that arrived within 2 s. GLOBAL_POSITION_INT "
      "requires `world.origin`; at latitude 0, longitude 0 it gives only the depth");
  section.section("origin", "pose of the vehicle's own origin in the world", [&](YamlSection& inner) {
    read_pose(inner, mavlink.T_world_local,
              "world position (x east, y north, z up) of the vehicle's (0, 0, 0)",
              "rotation; yaw 90 turns the vehicle's north to the west of the world");
  });
  return pose_input(std::move(mavlink));
}

}  // namespace

std::shared_ptr<const PoseInput> pose_input(MavlinkPoseInput settings) {
  return std::make_shared<MavlinkInput>(std::move(settings));
}

const PoseSourceType& mavlink_pose_source_type() {
  static const PoseSourceType type{
      .key = "mavlink",
      .meaning = "telemetry of a MAVLink vehicle by UDP ([simulators/ardusub.md](simulators/ardusub.md))",
      .read = &read_mavlink};
  return type;
}

}  // namespace sonard::server
