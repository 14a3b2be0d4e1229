// SPDX-License-Identifier: Apache-2.0
// From MAVLink messages to poses of the vehicle.
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
#include "server/config/config.hpp"
#include "server/program_log/reasons.hpp"

namespace sonard::server {

/// Counters, which only grow.
struct MavlinkPoseCounters {
  std::uint64_t bad_value = 0;         ///< not finite, no rotation, or out of bounds
  std::uint64_t unknown_frame = 0;     ///< ODOMETRY whose frame_id has no place in the world
  std::uint64_t without_attitude = 0;  ///< a position that no attitude was near enough to
  std::uint64_t without_place = 0;     ///< GLOBAL_POSITION_INT of a vehicle that does not know where it is
  std::uint64_t not_wanted = 0;        ///< of the kind that is not configured, or gives way to ODOMETRY
  std::uint64_t clock_restarts = 0;    ///< the vehicle's clock restarted
};

/// The messages of one vehicle, one by one; reads no clock and no socket.
///
/// ODOMETRY is a pose by itself. LOCAL_POSITION_NED, or GLOBAL_POSITION_INT where that is asked for, or where
/// with `auto` nothing better has come for `precedence` and the world has an origin, is one together with the
/// attitude at its time, told by time_boot_ms: that of a message of the same time, or between two at most
/// `longest_gap` apart on the shortest arc. A position that is newer than every attitude waits for the next
/// one. When the next position comes before it, the nearest attitude serves, turned on by its own rates, if
/// it is within `nearest_limit`. ATTITUDE and ATTITUDE_QUATERNION are worth the same.
///
/// Time stamps become times of ours by what the clock was when the first message arrived; the clock since
/// boot and that of ODOMETRY are two. A clock that goes back by more than PoseHistory::reset_threshold has
/// begun again (a reboot, a simulation that was reset): positions and attitudes of before are forgotten, and
/// poses go back by as much, so that PoseHistory forgets too. time_boot_ms begins again after 49.7 days, too.
///
/// A vehicle that does not know where it is sends GLOBAL_POSITION_INT at latitude 0, longitude 0: with `auto`
/// its altitude is its depth then, at the origin of its positions; where GLOBAL_POSITION_INT was asked for it
/// is dropped, and counted.
class MavlinkPoses {
 public:
  explicit MavlinkPoses(const MavlinkPoseInput& input);

  /// @return the pose that is known by this message, if it is one more: converted to enu_flu, as decode() of
  /// the pose stream vouches for it.
  std::optional<pose::PoseSample> take(const mavlink::Message& message, TimePoint arrival);

  const MavlinkPoseCounters& counters() const { return counters_; }
  /// The newest position is that of a vehicle that knows its depth alone.
  bool knows_depth_alone() const { return depth_alone_; }

  static constexpr std::int64_t longest_gap_ns = 500'000'000;
  static constexpr std::int64_t nearest_limit_ns = 100'000'000;
  /// With `messages: auto`, ODOMETRY goes before LOCAL_POSITION_NED, and both before GLOBAL_POSITION_INT,
  /// while they came within this time.
  static constexpr std::chrono::nanoseconds precedence = std::chrono::seconds{2};

 private:
  /// A clock of the vehicle.
  struct VehicleClock {
    std::optional<std::int64_t> offset_ns;  ///< ours minus the vehicle's, when the first message arrived
    std::int64_t newest_ns = 0;
  };
  struct Heading {
    pose::Quat q_ned_frd;
    pose::Vec3 rates_frd_radps;
  };
  struct Place {
    std::int64_t time_ns = 0;
    pose::Transform T_world_local;  ///< where its north, east and down begin, as east, north, up
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
  /// True when it began again.
  bool observe(VehicleClock& clock, std::int64_t stamp_ns, TimePoint arrival);
  /// Checked and converted; nullopt, counted, when it means nothing.
  std::optional<pose::PoseSample> sample(std::int64_t time_ns, const pose::Transform& T_world_local,
                                         pose::Transform T_ned_frd,
                                         const std::optional<pose::Velocity>& twist_frd);
  std::optional<pose::Velocity> twist_of(const mavlink::Odometry& odometry);
  void complain(const std::string& problem);

  Reasons complaints_;
  MavlinkMessages wanted_;
  pose::Transform T_world_local_;
  bool world_is_there_;  ///< at latitude 0, longitude 0
  std::optional<render::GeographicFrame> earth_;
  VehicleClock boot_clock_, odometry_clock_;
  std::map<std::int64_t, Heading> headings_;  // by the vehicle's time since boot
  std::optional<Place> waiting_;
  std::optional<TimePoint> last_odometry_;
  std::optional<TimePoint> last_local_;  ///< ODOMETRY or LOCAL_POSITION_NED, or the first message of all
  bool depth_alone_ = false;
  std::bitset<256> frames_said_, velocity_frames_said_;
  MavlinkPoseCounters counters_;
};

}  // namespace sonard::server
