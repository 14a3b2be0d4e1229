// SPDX-License-Identifier: Apache-2.0
#include "server/pose/mavlink/source.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <bit>
#include <bitset>
#include <string_view>
#include <utility>

#include "protocol/mavlink/frames.hpp"
#include "server/net/addresses.hpp"
#include "server/pose/mavlink/poses.hpp"
#include "server/pose/udp_listener.hpp"
#include "server/pose/unreadable_messages.hpp"

namespace sonard::server {

namespace {

/// Counts of the vehicle's frames, by their use.
struct Received {
  std::uint64_t odometry = 0;
  std::uint64_t local_position = 0;
  std::uint64_t global_position = 0;
  std::uint64_t attitude = 0;
  std::uint64_t other = 0;
};

std::uint64_t& counter_of(const mavlink::Message& message, Received& received) {
  if (std::holds_alternative<mavlink::Odometry>(message)) {
    return received.odometry;
  }
  if (std::holds_alternative<mavlink::LocalPositionNed>(message)) {
    return received.local_position;
  }
  if (std::holds_alternative<mavlink::GlobalPositionInt>(message)) {
    return received.global_position;
  }
  return std::holds_alternative<std::monostate>(message) ? received.other : received.attitude;
}

/// Messages from which a pose can be made.
std::string_view expected_of(MavlinkMessages messages) {
  switch (messages) {
    case MavlinkMessages::automatic:
      return "ODOMETRY, or LOCAL_POSITION_NED or GLOBAL_POSITION_INT and an attitude";
    case MavlinkMessages::odometry:
      return "ODOMETRY";
    case MavlinkMessages::local_position:
      return "LOCAL_POSITION_NED and an attitude";
    case MavlinkMessages::global_position:
      break;
  }
  return "GLOBAL_POSITION_INT and an attitude";
}

}  // namespace

struct MavlinkPoseSource::Impl : std::enable_shared_from_this<MavlinkPoseSource::Impl> {
  Impl(boost::asio::io_context& io, MavlinkPoseInput configured, const Clock& clock, PoseSink poses_go_to)
      : input(std::move(configured)),
        listener(io, "pose mavlink udp", input.bind, input.allow, clock),
        sink(std::move(poses_go_to)),
        poses(input) {}

  void take(std::span<const std::uint8_t> datagram, TimePoint arrival);
  void take(const mavlink::Frame& frame, TimePoint arrival);
  /// True if the frame is from the configured vehicle.
  bool is_ours(const mavlink::Frame& frame);
  void tell_what_is_missing(TimePoint arrival);
  /// Why received GLOBAL_POSITION_INT messages give no pose; empty if no reason is known.
  std::string what_is_missing() const;
  void tell_of_broken_frames(std::uint64_t before, TimePoint arrival);
  void note_unreadable(TimePoint arrival, std::string problem) {
    unreadable.note(arrival, endpoint_text(listener.peer()), std::move(problem));
  }

  MavlinkPoseInput input;
  UdpListener listener;
  PoseSink sink;
  std::optional<PublisherId> publisher;  // of the newest pose
  bool pose_of_odometry = false;         // the newest pose is that of an ODOMETRY
  MavlinkPoses poses;
  mavlink::FrameCounters frames;
  Received received;
  std::uint64_t wrong_system = 0;
  std::uint64_t wrong_component = 0;
  std::uint64_t broken_datagrams = 0;
  std::bitset<256> systems_said, components_said;
  std::optional<TimePoint> first_received;
  bool missing_said = false;
  PoseSourceCounters counters;
  UnreadableMessages unreadable;
};

void MavlinkPoseSource::Impl::take(std::span<const std::uint8_t> datagram, TimePoint arrival) {
  const std::uint64_t broken_before = frames.stray_bytes;
  mavlink::FrameReader reader(datagram, frames);
  while (const std::optional<mavlink::Frame> frame = reader.next()) {
    take(*frame, arrival);
    if (!listener.is_open()) {
      return;
    }
  }
  tell_of_broken_frames(broken_before, arrival);
}

void MavlinkPoseSource::Impl::take(const mavlink::Frame& frame, TimePoint arrival) {
  if (!is_ours(frame)) {
    return;
  }
  const auto message = mavlink::decode(frame);
  if (!message) {
    ++counters.malformed;
    note_unreadable(arrival, "a MAVLink message cannot be decoded");
    return;
  }
  ++counter_of(*message, received);
  const std::optional<pose::PoseSample> sample = poses.take(*message, arrival);
  const std::uint64_t bad_before = std::exchange(counters.bad_value, poses.counters().bad_value);
  if (counters.bad_value != bad_before) {
    note_unreadable(arrival, poses.newest_problem());
  }
  if (sample) {
    ++counters.samples;
    publisher = {listener.peer(), frame.system_id, frame.component_id};
    pose_of_odometry = std::holds_alternative<mavlink::Odometry>(*message);
    sink(*sample, arrival);
  } else {
    tell_what_is_missing(arrival);
  }
}

bool MavlinkPoseSource::Impl::is_ours(const mavlink::Frame& frame) {
  if (frame.system_id != input.system_id) {
    ++wrong_system;
    if (!systems_said.test(frame.system_id)) {
      systems_said.set(frame.system_id);
      spdlog::info("{}: system {} is ignored (poses.mavlink.system_id is {})", listener.description(),
                   frame.system_id, input.system_id);
    }
    return false;
  }
  if (frame.component_id != input.component_id) {
    ++wrong_component;
    if (!components_said.test(frame.component_id)) {
      components_said.set(frame.component_id);
      spdlog::info("{}: component {} of system {} is ignored (poses.mavlink.component_id is {})",
                   listener.description(), frame.component_id, frame.system_id, input.component_id);
    }
    return false;
  }
  return true;
}

std::string MavlinkPoseSource::Impl::what_is_missing() const {
  if (received.global_position == 0) {
    return "";
  }
  if (poses.counters().without_place > 0) {
    return "GLOBAL_POSITION_INT is at latitude 0, longitude 0: the vehicle has no position; "
           "poses.mavlink.messages: auto uses only its depth";
  }
  if (received.attitude == 0) {
    return "GLOBAL_POSITION_INT arrives without an attitude: request ATTITUDE from the vehicle";
  }
  switch (input.messages) {
    case MavlinkMessages::automatic:
      if (poses.receives_depth_alone()) {
        return fmt::format(
            "GLOBAL_POSITION_INT gives only a depth, which sonard uses if no position arrives "
            "for {} s",
            std::chrono::duration_cast<std::chrono::seconds>(MavlinkPoses::precedence).count());
      }
      return input.world_origin ? ""
                                : "GLOBAL_POSITION_INT arrives, which requires the position of the world on "
                                  "Earth (set world.origin)";
    case MavlinkMessages::odometry:
    case MavlinkMessages::local_position:
      return "GLOBAL_POSITION_INT arrives, which poses.mavlink.messages excludes: auto and global_position "
             "accept it";
    case MavlinkMessages::global_position:
      break;
  }
  return "";
}

void MavlinkPoseSource::Impl::tell_what_is_missing(TimePoint arrival) {
  first_received = first_received.value_or(arrival);
  if (missing_said || counters.samples > 0 || arrival - *first_received < patience) {
    return;
  }
  missing_said = true;
  const std::string lacks = what_is_missing();
  spdlog::warn(
      "{}: system {} has sent no usable pose in {} s: ODOMETRY {}, LOCAL_POSITION_NED {}, "
      "GLOBAL_POSITION_INT {}, ATTITUDE or ATTITUDE_QUATERNION {}, others {} (expected {}, by "
      "poses.mavlink.messages){}{}",
      listener.description(), input.system_id, patience.count(), received.odometry, received.local_position,
      received.global_position, received.attitude, received.other, expected_of(input.messages),
      lacks.empty() ? "" : ": ", lacks);
}

void MavlinkPoseSource::Impl::tell_of_broken_frames(std::uint64_t before, TimePoint arrival) {
  if (frames.stray_bytes == before) {
    return;
  }
  ++counters.malformed;
  note_unreadable(arrival, "it contains bytes that are not a valid MAVLink frame");
  if (std::has_single_bit(++broken_datagrams)) {
    spdlog::warn(
        "{}: datagram from {} contains {} bytes that are not a valid frame (bad checksums {} so far)",
        listener.description(), endpoint_text(listener.peer()), frames.stray_bytes - before,
        frames.bad_checksums);
  }
}

MavlinkPoseSource::MavlinkPoseSource(boost::asio::io_context& io, MavlinkPoseInput input, const Clock& clock,
                                     PoseSink sink)
    : impl_(std::make_shared<Impl>(io, std::move(input), clock, std::move(sink))) {}

MavlinkPoseSource::~MavlinkPoseSource() {
  MavlinkPoseSource::stop();
}

void MavlinkPoseSource::start() {
  impl_->listener.start(
      [weak = impl_->weak_from_this()](std::span<const std::uint8_t> datagram, TimePoint arrival) {
        if (const auto impl = weak.lock()) {
          impl->take(datagram, arrival);
        }
      });
}

void MavlinkPoseSource::stop() {
  impl_->listener.close();
}

std::string MavlinkPoseSource::description() const {
  return fmt::format("{} system {} component {}", impl_->listener.description(), impl_->input.system_id,
                     impl_->input.component_id);
}

const PoseSourceCounters& MavlinkPoseSource::counters() const {
  impl_->counters.refused = impl_->listener.refused();
  return impl_->counters;
}

std::string MavlinkPoseSource::details() const {
  const MavlinkPoseCounters& poses = impl_->poses.counters();
  return fmt::format(
      " messages={} bad_checksums={} unknown_flags={} stray_bytes={} wrong_system={} wrong_component={} "
      "unknown_frame={} without_attitude={} not_wanted={} clock_restarts={}",
      impl_->frames.frames, impl_->frames.bad_checksums, impl_->frames.unknown_flags,
      impl_->frames.stray_bytes, impl_->wrong_system, impl_->wrong_component, poses.unknown_frame,
      poses.without_attitude, poses.not_wanted, poses.clock_restarts);
}

std::optional<PublisherId> MavlinkPoseSource::publisher() const {
  return impl_->publisher;
}

StampField MavlinkPoseSource::stamp_field() const {
  return impl_->pose_of_odometry ? StampField{"time_usec", "microseconds", 1e-6}
                                 : StampField{"time_boot_ms", "milliseconds", 1e-3};
}

std::string MavlinkPoseSource::remark() const {
  return impl_->poses.knows_depth_alone()
             ? "The vehicle has a depth but no position (GLOBAL_POSITION_INT is at latitude 0, longitude 0), "
               "so it stays at poses.mavlink.origin. Set its origin in the ground station, or send poses "
               "with a position."
             : "";
}

std::string MavlinkPoseSource::unreadable(TimePoint now) const {
  return impl_->unreadable.text(now);
}

std::string MavlinkPoseSource::silence_hint() const {
  const Received& received = impl_->received;
  if (const std::string lacks = impl_->what_is_missing(); !lacks.empty()) {
    return lacks;
  }
  if (received.odometry + received.local_position + received.global_position + received.attitude +
          received.other >
      0) {
    return "messages of the vehicle arrive, but no positions with attitudes: request them "
           "(docs/simulators/ardusub.md)";
  }
  if (impl_->wrong_system + impl_->wrong_component > 0) {
    return "messages arrive only from other systems or components: is poses.mavlink.system_id the ID of the "
           "vehicle?";
  }
  return PoseSource::silence_hint();
}

Endpoint MavlinkPoseSource::local_endpoint() const {
  return impl_->listener.local();
}

}  // namespace sonard::server
