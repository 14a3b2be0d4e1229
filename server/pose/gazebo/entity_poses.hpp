// SPDX-License-Identifier: Apache-2.0
// Maps the entities of a simulator to our vehicle and bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/pose/pose_codec.hpp"
#include "server/pose/gazebo/input.hpp"

namespace sonard::server {

/// Poses that a simulator sent for one instant, unchecked. Axes are ENU and FLU.
struct EntityPoses {
  std::optional<std::int64_t> time_ns;  ///< simulated time; nullopt: the message has no stamp
  std::vector<pose::NamedTransform> entities;
};

/// Finds the configured entities in each message, and composes poses that are relative to parents. Ignores
/// other entities. Reads no clock and no socket.
class EntityMap {
 public:
  explicit EntityMap(const GazeboPoseInput& input);

  /// Converts a message to a sample. A body that is not in the message stays where it was, so the sample
  /// omits it.
  /// @return an error text if the vehicle's pose is missing, a needed pose is invalid, or a needed name is
  /// not unique: no image is better than an image from a wrong place
  Result<pose::PoseSample, std::string> map(const EntityPoses& poses);

  /// Ignored names that are new since the last call, from among seen().
  std::vector<std::string> take_ignored();
  /// Names of received entities, in alphabetical order: the first max_seen that arrived.
  std::vector<std::string> seen() const { return {seen_.begin(), seen_.end()}; }

  static constexpr std::size_t max_seen = 256;

 private:
  bool is_configured(std::string_view name) const;
  void note(const EntityPoses& poses);

  SimulatorEntity vehicle_;
  pose::Transform T_entity_vehicle_;
  std::vector<GazeboPoseInput::Body> bodies_;
  std::set<std::string, std::less<>> configured_;
  std::set<std::string, std::less<>> seen_;
  std::vector<std::string> new_ignored_;
};

}  // namespace sonard::server
