// SPDX-License-Identifier: Apache-2.0
#include "server/pose/gazebo/input.hpp"

#include <utility>

#include <fmt/format.h>

#include "server/error/error.hpp"
#include "server/pose/gazebo/source.hpp"
#include "server/yaml/pose_section.hpp"
#include "server/yaml/status_section.hpp"

namespace sonard::server {
namespace {

class GazeboInput final : public PoseInputWith<GazeboPoseInput> {
 public:
  explicit GazeboInput(GazeboPoseInput values)
      : PoseInputWith(gazebo_pose_source_type(), std::move(values)) {}

  std::string summary() const override {
    return fmt::format("gazebo {} entity '{}'", settings.topic, settings.vehicle.name);
  }

  std::shared_ptr<const PoseInput> in_world(const WorldOfPoses& world,
                                            std::vector<ConfigProblem>& problems) const override {
    if (!settings.vehicle.name.empty()) {
      return nullptr;
    }
    if (world.vehicle_model.empty()) {
      problems.push_back(
          {{},
           "poses.gazebo.vehicle",
           "missing (expected the name of an entity of the simulator; otherwise, world.vehicle_model "
           "or a mount from_world must name the model with the sonars)"});
    }
    GazeboPoseInput named = settings;
    named.vehicle = {world.vehicle_model, {}};
    return pose_input(std::move(named));
  }

  std::unique_ptr<PoseSource> open([[maybe_unused]] boost::asio::io_context& io,
                                   [[maybe_unused]] const Clock& clock, [[maybe_unused]] PoseSink sink,
                                   PoseHold /*hold*/) const override {
#ifdef SONARD_HAS_GAZEBO
    return std::make_unique<GazeboPoseSource>(io, settings, clock, std::move(sink));
#else
    throw Error(ErrorKind::configuration, "this sonard was built without Gazebo Transport", "poses.gazebo");
#endif
  }
};

/// "parents": the entities that a relative pose is relative to.
void read_parents(YamlSection& section, bool relative, SimulatorEntity& entity, std::string_view meaning) {
  constexpr TextForm names{"names of entities, the outermost first", "texts", R"("type": "string")"};
  section.parsed_list("parents", entity.parents, &any_text, names, meaning);
  if (!relative && section.has("parents")) {
    section.report("parents", "is invalid with `frame: world` (expected `frame: relative`)");
  }
}

std::shared_ptr<const PoseInput> read_gazebo(YamlSection& section, const std::filesystem::path& /*folder*/) {
  GazeboPoseInput gazebo;
  enum class Frame { world, relative };
  Frame frame = Frame::world;
  section.require("topic", "a topic such as /world/ocean/dynamic_pose/info");
  section.text("topic", gazebo.topic, "topic with `Pose_V` or `Pose` messages");
  section.text("partition", gazebo.partition, "partition of the Gazebo transport");
  section.default_is("partition", "value of `IGN_PARTITION` (Fortress) or `GZ_PARTITION`");
  read_own_address(
      section, "address", gazebo.address,
      "address of this machine on the network to Gazebo, instead of `IGN_IP` and `GZ_IP`. Default: loopback, "
      "so only this machine can publish poses. With any other address, every machine on that network can");
  section.require("frame", "world, or relative for poses that are relative to parents");
  section.choice("frame", frame, {{"world", Frame::world}, {"relative", Frame::relative}},
                 "reference frame of the poses: `world`, or `relative` to `parents`");
  const bool relative = frame == Frame::relative;
  section.text("vehicle", gazebo.vehicle.name,
               "entity that carries the sonars; **required** if no model of the world is the vehicle");
  section.default_is("vehicle", "`world.vehicle_model`");
  read_parents(section, relative, gazebo.vehicle,
               "entities that the pose of `vehicle` is relative to, the outermost first; [] for a model "
               "directly in the world");
  section.default_is("parents", "**required** with `relative` and `vehicle`");
  const bool named = section.has("vehicle");
  if (relative && named) {
    section.require("parents",
                    "the entities that the vehicle's pose is relative to, the outermost first; [] for a "
                    "model directly in the world");
  }
  for (const char* key : {"parents", "mount"}) {
    if (!named && section.has(key)) {
      section.report(key, "requires `vehicle`, which is missing (expected both, or neither)");
    }
  }
  section.section(
      "mount", "pose of the vehicle frame on the entity; only with `vehicle`", [&](YamlSection& inner) {
        read_pose(inner, gazebo.T_entity_vehicle, "origin of the vehicle frame in the axes of the entity",
                  "rotation, as in `poses.initial`");
      });
  section.sections("bodies", "simulator entities that move bodies of the world", [&](YamlSection& inner) {
    GazeboPoseInput::Body& body = gazebo.bodies.emplace_back();
    inner.require("entity", "the name of an entity of the simulator");
    inner.text("entity", body.entity.name, "name of the entity in the simulator");
    read_parents(inner, relative, body.entity,
                 "as the other `parents`, for `entity`; only with `frame: relative`");
    inner.require("body", "the name of a model of the world");
    inner.text("body", body.body, "name of the model in the world of sonard");
  });
  return pose_input(std::move(gazebo));
}

}  // namespace

std::shared_ptr<const PoseInput> pose_input(GazeboPoseInput settings) {
  return std::make_shared<GazeboInput>(std::move(settings));
}

const PoseSourceType& gazebo_pose_source_type() {
  static const PoseSourceType type{
      .key = "gazebo",
      .former_key = "ignition",
      .meaning = "pose topic of Gazebo ([simulators/gazebo.md](simulators/gazebo.md))",
      .read = &read_gazebo};
  return type;
}

}  // namespace sonard::server
