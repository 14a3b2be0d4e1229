#include "server/pose/mavlink_pose_source.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <array>
#include <bit>
#include <bitset>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <utility>

#include "protocol/mavlink/frames.hpp"
#include "server/config/addresses.hpp"
#include "server/pose/mavlink_poses.hpp"

namespace sonard::server {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

namespace {

/// Frames of the vehicle, by what they are good for.
struct Heard {
  std::uint64_t odometry = 0;
  std::uint64_t position = 0;
  std::uint64_t attitude = 0;
  std::uint64_t other = 0;
};

std::uint64_t& counter_of(const mavlink::Message& message, Heard& heard) {
  if (std::holds_alternative<mavlink::Odometry>(message)) {
    return heard.odometry;
  }
  if (std::holds_alternative<mavlink::LocalPositionNed>(message)) {
    return heard.position;
  }
  return std::holds_alternative<std::monostate>(message) ? heard.other : heard.attitude;
}

}  // namespace

struct MavlinkPoseSource::Impl : std::enable_shared_from_this<MavlinkPoseSource::Impl> {
  Impl(asio::io_context& io, MavlinkPoseInput configured, const Clock& used_clock, PoseSink poses_go_to)
      : input(std::move(configured)),
        clock(used_clock),
        sink(std::move(poses_go_to)),
        socket(io),
        poses(input) {}

  void open();
  void receive();
  void on_received(const error_code& error, std::size_t length);
  void take(std::span<const std::uint8_t> datagram);
  void take(const mavlink::Frame& frame, TimePoint arrival);
  /// True when the frame is of the vehicle that is listened to.
  bool is_ours(const mavlink::Frame& frame);
  void tell_what_is_missing(TimePoint arrival);
  void tell_of_broken_frames(std::uint64_t before);

  MavlinkPoseInput input;
  const Clock& clock;
  PoseSink sink;
  udp::socket socket;
  Endpoint local;
  udp::endpoint peer;
  std::optional<Endpoint> publisher;  // of the newest pose
  std::array<std::uint8_t, pose::max_message_bytes> buffer{};
  MavlinkPoses poses;
  mavlink::FrameCounters frames;
  Heard heard;
  std::uint64_t wrong_system = 0;
  std::uint64_t wrong_component = 0;
  std::uint64_t broken_datagrams = 0;
  std::bitset<256> systems_said, components_said;
  std::optional<TimePoint> first_heard;
  bool missing_said = false;
  PoseSourceCounters counters;
};

void MavlinkPoseSource::Impl::open() {
  error_code error;
  const auto check = [&](const char* operation) {
    if (error) {
      throw PoseSourceError(
          fmt::format("mavlink udp {}: {}: {}", endpoint_text(input.bind), operation, error.message()));
    }
  };
  socket.open(udp::v4(), error);
  check("open");
  socket.bind({asio::ip::address_v4{input.bind.address}, input.bind.port}, error);
  check("bind");
  const udp::endpoint bound = socket.local_endpoint(error);
  check("local address");
  local = {bound.address().to_v4().to_uint(), bound.port()};
}

void MavlinkPoseSource::Impl::receive() {
  socket.async_receive_from(asio::buffer(buffer), peer,
                            [self = shared_from_this()](const error_code& error, std::size_t length) {
                              self->on_received(error, length);
                            });
}

void MavlinkPoseSource::Impl::on_received(const error_code& error, std::size_t length) {
  if (!socket.is_open()) {
    return;
  }
  // An error here is a report about one datagram (for example an ICMP answer); the socket goes on.
  if (!error) {
    take(std::span{buffer}.first(length));
  }
  if (socket.is_open()) {  // the sink may have stopped us
    receive();
  }
}

void MavlinkPoseSource::Impl::take(std::span<const std::uint8_t> datagram) {
  const TimePoint arrival = clock.now();
  if (!allows(input.allow, peer.address().to_v4().to_uint())) {
    if (std::has_single_bit(++counters.refused)) {
      spdlog::warn("mavlink udp {}: datagram from {} dropped: not in the allow list ({} so far)",
                   endpoint_text(local), endpoint_text({peer.address().to_v4().to_uint(), peer.port()}),
                   counters.refused);
    }
    return;
  }
  const std::uint64_t broken_before = frames.stray_bytes;
  mavlink::FrameReader reader(datagram, frames);
  while (const std::optional<mavlink::Frame> frame = reader.next()) {
    take(*frame, arrival);
    if (!socket.is_open()) {
      return;
    }
  }
  tell_of_broken_frames(broken_before);
}

void MavlinkPoseSource::Impl::take(const mavlink::Frame& frame, TimePoint arrival) {
  if (!is_ours(frame)) {
    return;
  }
  const auto message = mavlink::decode(frame);
  if (!message) {
    ++counters.malformed;
    return;
  }
  ++counter_of(*message, heard);
  const std::optional<pose::PoseSample> sample = poses.take(*message, arrival);
  counters.bad_value = poses.counters().bad_value;
  if (sample) {
    ++counters.samples;
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
      spdlog::info("mavlink udp {}: system {} is ignored (poses.mavlink.system_id is {})",
                   endpoint_text(local), frame.system_id, input.system_id);
    }
    return false;
  }
  if (frame.component_id != input.component_id) {
    ++wrong_component;
    if (!components_said.test(frame.component_id)) {
      components_said.set(frame.component_id);
      spdlog::info("mavlink udp {}: component {} of system {} is ignored (poses.mavlink.component_id is {})",
                   endpoint_text(local), frame.component_id, frame.system_id, input.component_id);
    }
    return false;
  }
  return true;
}

void MavlinkPoseSource::Impl::tell_what_is_missing(TimePoint arrival) {
  first_heard = first_heard.value_or(arrival);
  if (missing_said || counters.samples > 0 || arrival - *first_heard < patience) {
    return;
  }
  missing_said = true;
  spdlog::warn(
      "mavlink udp {}: system {} has given no pose in {} s: ODOMETRY {}, LOCAL_POSITION_NED {}, ATTITUDE or "
      "ATTITUDE_QUATERNION {}, others {} (expected the first, or the second and the third)",
      endpoint_text(local), input.system_id, patience.count(), heard.odometry, heard.position, heard.attitude,
      heard.other);
}

void MavlinkPoseSource::Impl::tell_of_broken_frames(std::uint64_t before) {
  if (frames.stray_bytes == before) {
    return;
  }
  ++counters.malformed;
  if (std::has_single_bit(++broken_datagrams)) {
    spdlog::warn(
        "mavlink udp {}: datagram from {} holds {} bytes of no valid frame (bad checksums {} so far)",
        endpoint_text(local), endpoint_text({peer.address().to_v4().to_uint(), peer.port()}),
        frames.stray_bytes - before, frames.bad_checksums);
  }
}

MavlinkPoseSource::MavlinkPoseSource(asio::io_context& io, MavlinkPoseInput input, const Clock& clock,
                                     PoseSink sink)
    : impl_(std::make_shared<Impl>(io, std::move(input), clock, std::move(sink))) {}

MavlinkPoseSource::~MavlinkPoseSource() {
  stop();
}

void MavlinkPoseSource::start() {
  impl_->open();
  impl_->receive();
}

void MavlinkPoseSource::stop() {
  error_code ignored;
  impl_->socket.close(ignored);
}

std::string MavlinkPoseSource::description() const {
  const bool started = impl_->local.port != 0;
  return fmt::format("mavlink udp {} system {} component {}",
                     endpoint_text(started ? impl_->local : impl_->input.bind), impl_->input.system_id,
                     impl_->input.component_id);
}

const PoseSourceCounters& MavlinkPoseSource::counters() const {
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

std::string MavlinkPoseSource::heard() const {
  return impl_->publisher ? fmt::format("from {} system {} component {}", endpoint_text(*impl_->publisher),
                                        impl_->input.system_id, impl_->input.component_id)
                          : std::string();
}

std::string MavlinkPoseSource::silence_hint() const {
  const Heard& heard = impl_->heard;
  if (heard.odometry + heard.position + heard.attitude + heard.other > 0) {
    return "the vehicle is heard, but does not say where it is: ask it for positions and attitudes "
           "(docs/simulators/ardusub.md)";
  }
  if (impl_->wrong_system + impl_->wrong_component > 0) {
    return "other systems or components are heard: is poses.mavlink.system_id that of the vehicle?";
  }
  return PoseSource::silence_hint();
}

Endpoint MavlinkPoseSource::local_endpoint() const {
  return impl_->local;
}

}  // namespace sonard::server
