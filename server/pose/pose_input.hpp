// SPDX-License-Identifier: Apache-2.0
// A configured source of poses, before it is opened. Each type of source has a folder here
// (docs/architecture.md).
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "server/clock/clock.hpp"
#include "server/net/planned_socket.hpp"
#include "server/pose/pose_config.hpp"
#include "server/pose/pose_source.hpp"
#include "server/yaml/config_error.hpp"
#include "server/yaml/yaml_section.hpp"

namespace boost::asio {
class io_context;
}

namespace sonard::server {

/// A type of pose source: an entry of the list in server/pose/types.
struct PoseSourceType {
  std::string_view key;           ///< of its section in `poses`: "udp"
  std::string_view former_key{};  ///< an earlier name of this key; empty: none
  std::string_view meaning;       ///< of the section, for the schema and docs/configuration.md
  bool is_live = true;            ///< others send the poses; false: a recording gives them
  /// Reads the section. @param folder of the configuration file; relative paths start there
  std::shared_ptr<const PoseInput> (*read)(YamlSection& section, const std::filesystem::path& folder);
};

/// Values of the world that an input may need.
struct WorldOfPoses {
  std::string vehicle_model;                       ///< WorldConfig::vehicle_model
  std::optional<render::GeographicOrigin> origin;  ///< the world's place on Earth
};

/// The pose of the vehicle with which an input begins.
struct FirstPose {
  std::string key;  ///< that gives it: "poses.trajectory.file"
  render::Pose T_world_vehicle;
};

/// One input of the configuration. Immutable.
class PoseInput {
 public:
  explicit PoseInput(const PoseSourceType& type) : type_(type) {}
  virtual ~PoseInput() = default;

  const PoseSourceType& type() const { return type_; }

  /// For `sonard check`: "UDP 127.0.0.1:14600".
  /// @throws Error if the input needs a file that cannot be used
  virtual std::string summary() const = 0;
  /// The socket that it binds; nullopt: it binds none.
  virtual std::optional<PlannedSocket> socket() const { return std::nullopt; }
  /// nullopt if it is not known before the input is opened.
  virtual std::optional<FirstPose> first_pose() const { return std::nullopt; }
  /// This input with the values that the world gives it; null if it needs none.
  /// @param problems receives values that are missing
  virtual std::shared_ptr<const PoseInput> in_world(const WorldOfPoses& /*world*/,
                                                    std::vector<ConfigProblem>& /*problems*/) const {
    return nullptr;
  }
  /// @param clock outlives the source, like `io`
  /// @param hold may be empty: publishers then never wait
  /// @throws Error
  virtual std::unique_ptr<PoseSource> open(boost::asio::io_context& io, const Clock& clock, PoseSink sink,
                                           PoseHold hold) const = 0;

 private:
  const PoseSourceType& type_;
};

/// An input with its settings as plain values.
template <typename Settings>
class PoseInputWith : public PoseInput {
 public:
  PoseInputWith(const PoseSourceType& type, Settings values) : PoseInput(type), settings(std::move(values)) {}

  Settings settings;
};

/// Settings of the input that has settings of this type; null if no input has.
template <typename Settings>
const Settings* settings_of(const PoseConfig& poses) {
  for (const std::shared_ptr<const PoseInput>& input : poses.inputs) {
    if (const auto* found = dynamic_cast<const PoseInputWith<Settings>*>(input.get())) {
      return &found->settings;
    }
  }
  return nullptr;
}

}  // namespace sonard::server
