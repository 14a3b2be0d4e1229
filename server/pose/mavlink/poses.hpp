// SPDX-License-Identifier: Apache-2.0
// Converts MAVLink messages to poses of the vehicle.
#pragma once

#include <bitset>
#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "protocol/mavlink/messages.hpp"
#include "protocol/pose/pose_codec.hpp"
#include "renderer/scene/geographic_frame.hpp"
#include "server/clock/clock.hpp"
#include "server/pose/mavlink/input.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

/// Counters; they only grow.
struct MavlinkPoseCounters {
  std::uint64_t bad_value = 0;         ///< not finite, not a rotation, or out of bounds
  std::uint64_t unknown_frame = 0;     ///< ODOMETRY with an unsupported frame_id
  std::uint64_t without_attitude = 0;  ///< a position without an attitude near enough in time
  std::uint64_t without_place = 0;     ///< GLOBAL_POSITION_INT of a vehicle without a position fix
  std::uint64_t not_wanted = 0;        ///< a kind that is not configured, or that ODOMETRY overrides
  std::uint64_t clock_restarts = 0;    ///< the vehicle's clock restarted
};

/// Processes the messages of one vehicle, one by one; reads no clock and no socket.
///
/// ODOMETRY gives a pose by itself. LOCAL_POSITION_NED gives one together with the attitude at its time
/// (time_boot_ms). So does GLOBAL_POSITION_INT if it is configured. With `auto`, GLOBAL_POSITION_INT is used
/// if no better message has come for `precedence` and the world has an origin. The attitude is from a message
/// of the same time, or interpolated on the shortest arc between two at most `longest_gap` apart. A position
/// newer than every attitude waits for the next attitude. If the next position comes first, the nearest
/// attitude within `nearest_limit` is used, rotated by its own rates. ATTITUDE and ATTITUDE_QUATERNION count
/// the same.
///
/// The offset from the vehicle's clock to ours is fixed when the first message arrives. The clock since boot
/// and the clock of ODOMETRY have separate offsets. A clock that goes back by more than
/// PoseHistory::reset_threshold has restarted (a reboot, or a simulation reset). Earlier positions and
/// attitudes are then dropped, and poses go back by the same time, so that PoseHistory drops its poses too.
/// time_boot_ms wraps after 49.7 days, with the same effect.
///
/// A vehicle without a position fix sends GLOBAL_POSITION_INT at latitude 0, longitude 0. With `auto`, its
/// altitude is then used as depth at the origin of its positions, so the world needs no place on Earth. This
/// is the altitude above home, or above mean sea level if the vehicle leaves the other at 0. If
/// GLOBAL_POSITION_INT is configured, the message is dropped and counted.
class MavlinkPoses {
 public:
  explicit MavlinkPoses(const MavlinkPoseInput& input);

  /// @return the pose that this message completes, if any: converted to enu_flu and checked like the output
  /// of pose::decode()
  std::optional<pose::PoseSample> take(const mavlink::Message& message, TimePoint arrival);

  const MavlinkPoseCounters& counters() const { return counters_; }
  /// Why the newest message with a bad value was dropped; empty before the first one.
  const std::string& newest_problem() const { return newest_problem_; }
  /// True if the newest position has only a depth, because the vehicle has no fix.
  bool knows_depth_alone() const { return depth_alone_; }
  /// True if the newest GLOBAL_POSITION_INT, used or not, has only a depth.
  bool receives_depth_alone() const { return global_without_place_; }

  static constexpr std::int64_t longest_gap_ns = 500'000'000;
  static constexpr std::int64_t nearest_limit_ns = 100'000'000;
  /// With `messages: auto`, ODOMETRY overrides LOCAL_POSITION_NED, and both override GLOBAL_POSITION_INT, if
  /// they came within this time.
  static constexpr std::chrono::nanoseconds precedence = std::chrono::seconds{2};

 private:
  /// State of a clock of the vehicle.
  struct VehicleClock {
    std::optional<std::int64_t> offset_ns;  ///< our time minus the vehicle's, when the first message arrived
    std::int64_t newest_ns = 0;
  };
  struct Heading {
    pose::Quat q_ned_frd;
    pose::Vec3 rates_frd_radps;
  };
  struct Place {
    std::int64_t time_ns = 0;
    pose::Transform T_world_local;  ///< origin of north, east, down in the world, with axes east, north, up
    pose::Vec3 position_ned_m;
    pose::Vec3 velocity_ned_mps;
  };

  std::optional<pose::PoseSample> take_message(std::monostate, TimePoint arrival);
  std::optional<pose::PoseSample> take_message(const mavlink::Attitude& attitude, TimePoint arrival);
  std::optional<pose::PoseSample> take_message(const mavlink::AttitudeQuaternion& attitude,
                                               TimePoint arrival);
  std::optional<pose::PoseSample> take_message(const mavlink::LocalPositionNed& position, TimePoint arrival);
  std::optional<pose::PoseSample> take_message(const mavlink::GlobalPositionInt& position, TimePoint arrival);
  std::optional<pose::PoseSample> take_message(const mavlink::Odometry& odometry, TimePoint arrival);

  std::optional<pose::PoseSample> add(std::int64_t boot_ns, Heading heading, TimePoint arrival);
  std::optional<pose::PoseSample> add(const Place& place, TimePoint arrival);
  std::optional<pose::PoseSample> joined(const Place& place, const std::optional<Heading>& heading);
  std::optional<Heading> between(std::int64_t time_ns) const;
  std::optional<Heading> nearest(std::int64_t time_ns) const;
  bool attitude_is_wanted(TimePoint arrival) const;
  bool local_position_is_wanted(TimePoint arrival) const;
  bool global_position_is_wanted(TimePoint arrival);
  double height_m(const mavlink::GlobalPositionInt& position);
  /// Returns true if the clock restarted.
  bool observe(VehicleClock& clock, std::int64_t stamp_ns, TimePoint arrival);
  /// Checks and converts a pose; nullopt, and counted, if it is invalid.
  std::optional<pose::PoseSample> sample(std::int64_t time_ns, const pose::Transform& T_world_local,
                                         pose::Transform T_ned_frd,
                                         const std::optional<pose::Velocity>& twist_frd);
  std::optional<pose::Velocity> twist_of(const mavlink::Odometry& odometry);
  void complain(const std::string& problem);

  Reasons complaints_;
  std::string newest_problem_;
  MavlinkMessages wanted_;
  pose::Transform T_world_local_;
  bool world_is_there_;  ///< the world is near latitude 0, longitude 0
  std::optional<render::GeographicFrame> earth_;
  VehicleClock boot_clock_, odometry_clock_;
  std::map<std::int64_t, Heading> headings_;  // by the vehicle's time since boot
  std::optional<Place> waiting_;
  std::optional<TimePoint> last_odometry_;
  std::optional<TimePoint> last_local_;  ///< ODOMETRY, LOCAL_POSITION_NED, or the very first message
  bool depth_alone_ = false;
  bool global_without_place_ = false;
  bool knows_height_above_home_ = false;  ///< relative_alt was not always 0
  std::bitset<256> frames_said_, velocity_frames_said_;
  MavlinkPoseCounters counters_;
};

}  // namespace sonard::server
