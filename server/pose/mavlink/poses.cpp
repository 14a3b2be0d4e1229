// SPDX-License-Identifier: Apache-2.0
#include "server/pose/mavlink/poses.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include "server/pose/pose_history.hpp"

namespace sonard::server {
namespace {

using mavlink::MavFrame;

/// More than two seconds of the fastest stream; a position waits for only one attitude.
constexpr std::size_t most_headings = 256;
/// In a world this near to latitude 0, longitude 0, such a position may be real.
constexpr double near_deg = 0.1;

pose::Quat about_x(double angle_rad) {
  return {std::cos(angle_rad / 2), std::sin(angle_rad / 2), 0.0, 0.0};
}
pose::Quat about_y(double angle_rad) {
  return {std::cos(angle_rad / 2), 0.0, std::sin(angle_rad / 2), 0.0};
}
pose::Quat about_z(double angle_rad) {
  return {std::cos(angle_rad / 2), 0.0, 0.0, std::sin(angle_rad / 2)};
}

pose::Vec3 vec3(float x, float y, float z) {
  return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
}

bool is_speed(const pose::Vec3& v) {
  return pose::is_finite(v) && pose::norm(v) <= pose::max_speed;
}

pose::Transform to_pose(const render::Pose& pose) {
  const glm::dvec3& p = pose.position_m;
  const glm::dquat& q = pose.orientation;
  return {{p.x, p.y, p.z}, {q.w, q.x, q.y, q.z}};
}

pose::Transform operator*(const pose::Transform& T_a_b, const pose::Transform& T_b_c) {
  return {T_a_b.position_m + rotate(T_a_b.orientation, T_b_c.position_m),
          pose::normalized(T_a_b.orientation * T_b_c.orientation)};
}

std::int64_t boot_ns(std::uint32_t time_boot_ms) {
  return std::int64_t{time_boot_ms} * 1'000'000;
}

}  // namespace

MavlinkPoses::MavlinkPoses(const MavlinkPoseInput& input)
    : wanted_(input.messages),
      T_world_local_(to_pose(input.T_world_local)),
      world_is_there_(input.world_origin && std::abs(input.world_origin->latitude_deg) < near_deg &&
                      std::abs(input.world_origin->longitude_deg) < near_deg) {
  if (wanted_ == MavlinkMessages::global_position) {
    earth_.emplace(input.world_origin.value());
  } else if (wanted_ == MavlinkMessages::automatic && input.world_origin) {
    earth_.emplace(*input.world_origin);
  }
}

std::optional<pose::PoseSample> MavlinkPoses::take(const mavlink::Message& message, TimePoint arrival) {
  return std::visit([&](const auto& content) { return take_message(content, arrival); }, message);
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(std::monostate, TimePoint) {
  return std::nullopt;
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(const mavlink::Attitude& attitude,
                                                           TimePoint arrival) {
  const auto [roll, pitch, yaw] = vec3(attitude.roll, attitude.pitch, attitude.yaw);
  return add(boot_ns(attitude.time_boot_ms),
             {about_z(yaw) * about_y(pitch) * about_x(roll),
              vec3(attitude.rollspeed, attitude.pitchspeed, attitude.yawspeed)},
             arrival);
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(const mavlink::AttitudeQuaternion& attitude,
                                                           TimePoint arrival) {
  const pose::Vec3 imaginary = vec3(attitude.q2, attitude.q3, attitude.q4);
  return add(boot_ns(attitude.time_boot_ms),
             {{static_cast<double>(attitude.q1), imaginary.x, imaginary.y, imaginary.z},
              vec3(attitude.rollspeed, attitude.pitchspeed, attitude.yawspeed)},
             arrival);
}

std::optional<pose::PoseSample> MavlinkPoses::add(std::int64_t time_ns, Heading heading, TimePoint arrival) {
  if (!attitude_is_wanted(arrival)) {
    ++counters_.not_wanted;
    return std::nullopt;
  }
  pose::Transform checked{{}, heading.q_ned_frd};
  if (const auto fault = normalize(checked); fault != pose::TransformFault::none) {
    ++counters_.bad_value;
    complain(std::string("attitude: ") + describe(fault));
    return std::nullopt;
  }
  heading.q_ned_frd = checked.orientation;
  if (!is_speed(heading.rates_frd_radps)) {
    heading.rates_frd_radps = {};
  }
  if (observe(boot_clock_, time_ns, arrival)) {
    headings_.clear();
    waiting_.reset();
  }
  headings_.insert_or_assign(time_ns, heading);
  if (headings_.size() > most_headings) {
    headings_.erase(headings_.begin());
  }
  if (!waiting_ || time_ns < waiting_->time_ns) {
    return std::nullopt;
  }
  const Place place = *waiting_;
  waiting_.reset();
  return joined(place, between(place.time_ns));
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(const mavlink::LocalPositionNed& position,
                                                           TimePoint arrival) {
  if (!local_position_is_wanted(arrival)) {
    ++counters_.not_wanted;
    return std::nullopt;
  }
  last_local_ = arrival;
  depth_alone_ = false;
  return add(Place{boot_ns(position.time_boot_ms), T_world_local_, vec3(position.x, position.y, position.z),
                   vec3(position.vx, position.vy, position.vz)},
             arrival);
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(const mavlink::GlobalPositionInt& position,
                                                           TimePoint arrival) {
  const bool no_place = position.lat == 0 && position.lon == 0 && !world_is_there_;
  global_without_place_ = no_place;
  if (!global_position_is_wanted(arrival)) {
    ++counters_.not_wanted;
    return std::nullopt;
  }
  if (no_place && wanted_ == MavlinkMessages::automatic) {
    depth_alone_ = true;
    return add(Place{boot_ns(position.time_boot_ms),
                     T_world_local_,
                     {0, 0, -height_m(position)},
                     {0, 0, 0.01 * position.vz}},
               arrival);
  }
  if (no_place) {
    ++counters_.without_place;
    complain("GLOBAL_POSITION_INT is at latitude 0, longitude 0: the vehicle has no position");
    return std::nullopt;
  }
  if (!earth_) {
    ++counters_.not_wanted;
    return std::nullopt;
  }
  depth_alone_ = false;
  const double latitude_deg = 1e-7 * position.lat, longitude_deg = 1e-7 * position.lon;
  if (std::abs(latitude_deg) > 90.0 || std::abs(longitude_deg) > 180.0) {
    ++counters_.bad_value;
    complain("GLOBAL_POSITION_INT: latitude or longitude is out of range");
    return std::nullopt;
  }
  const render::Pose T_world_place = earth_->T_world_place(latitude_deg, longitude_deg, 1e-3 * position.alt);
  return add(Place{boot_ns(position.time_boot_ms),
                   to_pose(T_world_place),
                   {},
                   {0.01 * position.vx, 0.01 * position.vy, 0.01 * position.vz}},
             arrival);
}

std::optional<pose::PoseSample> MavlinkPoses::add(const Place& place, TimePoint arrival) {
  if (observe(boot_clock_, place.time_ns, arrival)) {
    headings_.clear();
    waiting_.reset();
  }
  if (!headings_.empty() && headings_.rbegin()->first >= place.time_ns) {
    return joined(place, between(place.time_ns));
  }
  const std::optional<Place> passed_over = waiting_;
  waiting_ = place;
  return passed_over ? joined(*passed_over, nearest(passed_over->time_ns)) : std::nullopt;
}

std::optional<pose::PoseSample> MavlinkPoses::joined(const Place& place,
                                                     const std::optional<Heading>& heading) {
  if (!heading) {
    ++counters_.without_attitude;
    complain("a position without an attitude of the same time");
    return std::nullopt;
  }
  std::optional<pose::Velocity> twist_frd;
  if (is_speed(place.velocity_ned_mps)) {
    twist_frd = {rotate(conjugate(heading->q_ned_frd), place.velocity_ned_mps), heading->rates_frd_radps};
  }
  return sample(place.time_ns + boot_clock_.offset_ns.value(), place.T_world_local,
                {place.position_ned_m, heading->q_ned_frd}, twist_frd);
}

std::optional<MavlinkPoses::Heading> MavlinkPoses::between(std::int64_t time_ns) const {
  const auto after = headings_.lower_bound(time_ns);
  if (after == headings_.end()) {
    return nearest(time_ns);
  }
  if (after->first == time_ns) {
    return after->second;
  }
  if (after == headings_.begin() || after->first - std::prev(after)->first > longest_gap_ns) {
    return nearest(time_ns);
  }
  const auto before = std::prev(after);
  const double fraction =
      static_cast<double>(time_ns - before->first) / static_cast<double>(after->first - before->first);
  const pose::Transform turned =
      pose::interpolate({{}, before->second.q_ned_frd}, {{}, after->second.q_ned_frd}, fraction);
  const pose::Vec3& rates = before->second.rates_frd_radps;
  return Heading{turned.orientation, rates + fraction * (after->second.rates_frd_radps - rates)};
}

std::optional<MavlinkPoses::Heading> MavlinkPoses::nearest(std::int64_t time_ns) const {
  const auto distance = [time_ns](const auto& entry) { return std::abs(entry.first - time_ns); };
  const auto found = std::min_element(headings_.begin(), headings_.end(), [&](const auto& a, const auto& b) {
    return distance(a) < distance(b);
  });
  if (found == headings_.end() || distance(*found) > nearest_limit_ns) {
    return std::nullopt;
  }
  const double seconds = 1e-9 * static_cast<double>(time_ns - found->first);
  const Heading& heading = found->second;
  return Heading{
      pose::normalized(heading.q_ned_frd * pose::from_rotation_vector(seconds * heading.rates_frd_radps)),
      heading.rates_frd_radps};
}

bool MavlinkPoses::attitude_is_wanted(TimePoint arrival) const {
  return wanted_ == MavlinkMessages::global_position || local_position_is_wanted(arrival);
}

bool MavlinkPoses::local_position_is_wanted(TimePoint arrival) const {
  switch (wanted_) {
    case MavlinkMessages::odometry:
    case MavlinkMessages::global_position:
      return false;
    case MavlinkMessages::local_position:
      return true;
    case MavlinkMessages::automatic:
      break;
  }
  return !last_odometry_ || arrival - *last_odometry_ > precedence;
}

// Waits for `precedence` after the first message, because a better message may follow.
bool MavlinkPoses::global_position_is_wanted(TimePoint arrival) {
  if (wanted_ != MavlinkMessages::automatic) {
    return wanted_ == MavlinkMessages::global_position;
  }
  last_local_ = last_local_.value_or(arrival);
  return arrival - *last_local_ > precedence;
}

/// The height of a vehicle without a place. Where home is above the sea, `alt` of a diving vehicle is
/// positive.
double MavlinkPoses::height_m(const mavlink::GlobalPositionInt& position) {
  knows_height_above_home_ = knows_height_above_home_ || position.relative_alt != 0;
  return 1e-3 * (knows_height_above_home_ ? position.relative_alt : position.alt);
}

std::optional<pose::PoseSample> MavlinkPoses::take_message(const mavlink::Odometry& odometry,
                                                           TimePoint arrival) {
  if (wanted_ == MavlinkMessages::local_position || wanted_ == MavlinkMessages::global_position) {
    ++counters_.not_wanted;
    return std::nullopt;
  }
  if (odometry.frame_id != MavFrame::local_ned && odometry.frame_id != MavFrame::local_frd) {
    ++counters_.unknown_frame;
    const auto number = static_cast<std::uint8_t>(odometry.frame_id);
    if (!frames_said_.test(number)) {
      frames_said_.set(number);
      spdlog::warn(
          "pose mavlink: ODOMETRY with frame_id {} is dropped (expected 1, MAV_FRAME_LOCAL_NED, or 20, "
          "MAV_FRAME_LOCAL_FRD)",
          number);
    }
    return std::nullopt;
  }
  if (odometry.time_usec > static_cast<std::uint64_t>(pose::max_time_ns / 1000)) {
    ++counters_.bad_value;
    complain("ODOMETRY: time_usec is out of range");
    return std::nullopt;
  }
  const std::int64_t time_ns = static_cast<std::int64_t>(odometry.time_usec) * 1000;
  const pose::Vec3 imaginary = vec3(odometry.q[1], odometry.q[2], odometry.q[3]);
  const pose::Transform T_local_frd{
      vec3(odometry.x, odometry.y, odometry.z),
      {static_cast<double>(odometry.q[0]), imaginary.x, imaginary.y, imaginary.z}};
  observe(odometry_clock_, time_ns, arrival);
  std::optional<pose::PoseSample> known =
      sample(time_ns + odometry_clock_.offset_ns.value(), T_world_local_, T_local_frd, twist_of(odometry));
  if (known) {
    last_odometry_ = last_local_ = arrival;
    depth_alone_ = false;
    headings_.clear();
    waiting_.reset();
  }
  return known;
}

std::optional<pose::Velocity> MavlinkPoses::twist_of(const mavlink::Odometry& odometry) {
  pose::Velocity twist{vec3(odometry.vx, odometry.vy, odometry.vz),
                       vec3(odometry.rollspeed, odometry.pitchspeed, odometry.yawspeed)};
  if (!is_speed(twist.linear_mps) || !is_speed(twist.angular_radps)) {
    return std::nullopt;  // NaN: the vehicle has no speed estimate
  }
  const MavFrame axes = odometry.child_frame_id;
  if (axes == MavFrame::body_frd || axes == MavFrame::body_ned) {
    return twist;
  }
  if (axes == odometry.frame_id) {
    const pose::Vec3 imaginary = vec3(odometry.q[1], odometry.q[2], odometry.q[3]);
    pose::Transform checked{{}, {static_cast<double>(odometry.q[0]), imaginary.x, imaginary.y, imaginary.z}};
    if (normalize(checked) != pose::TransformFault::none) {
      return std::nullopt;
    }
    twist.linear_mps = rotate(conjugate(checked.orientation), twist.linear_mps);
    return twist;
  }
  const auto number = static_cast<std::uint8_t>(axes);
  if (!velocity_frames_said_.test(number)) {
    velocity_frames_said_.set(number);
    spdlog::warn(
        "pose mavlink: the velocity of ODOMETRY with child_frame_id {} is not used (expected 12, "
        "MAV_FRAME_BODY_FRD)",
        number);
  }
  return std::nullopt;
}

bool MavlinkPoses::observe(VehicleClock& clock, std::int64_t stamp_ns, TimePoint arrival) {
  if (!clock.offset_ns) {
    clock = {arrival.count() - stamp_ns, stamp_ns};
    return false;
  }
  const std::int64_t back_ns = clock.newest_ns - stamp_ns;
  const bool restarted = back_ns > PoseHistory::reset_threshold.count();
  clock.newest_ns = restarted ? stamp_ns : std::max(clock.newest_ns, stamp_ns);
  if (restarted && std::has_single_bit(++counters_.clock_restarts)) {
    spdlog::warn("pose mavlink: the vehicle's clock restarted, {:.3f} s back ({} so far)",
                 1e-9 * static_cast<double>(back_ns), counters_.clock_restarts);
  }
  return restarted;
}

std::optional<pose::PoseSample> MavlinkPoses::sample(std::int64_t time_ns,
                                                     const pose::Transform& T_world_local,
                                                     pose::Transform T_ned_frd,
                                                     const std::optional<pose::Velocity>& twist_frd) {
  if (const auto fault = normalize(T_ned_frd); fault != pose::TransformFault::none) {
    ++counters_.bad_value;
    complain(describe(fault));
    return std::nullopt;
  }
  pose::PoseSample result;
  result.time_ns = std::clamp(time_ns, -pose::max_time_ns, pose::max_time_ns);
  result.T_world_vehicle = T_world_local * pose::enu_flu_from_ned_frd(T_ned_frd);
  if (twist_frd) {
    result.twist = pose::flu_from_frd(*twist_frd);
  }
  return result;
}

void MavlinkPoses::complain(const std::string& problem) {
  newest_problem_ = problem;
  if (const std::uint64_t count = complaints_.count(problem); std::has_single_bit(count)) {
    spdlog::warn("pose mavlink: message dropped: {} ({} so far)", problem, count);
  }
}

}  // namespace sonard::server
