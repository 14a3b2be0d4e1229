// SPDX-License-Identifier: Apache-2.0
// The only file that includes the headers of Gazebo's transport, which take seconds to compile.
#include "server/pose/gazebo/source.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <mutex>
#include <utility>

#include "server/error/error.hpp"
#include "server/net/addresses.hpp"
#include "server/pose/gazebo/entity_poses.hpp"
#include "server/pose/gazebo/network.hpp"
#include "server/pose/unreadable_messages.hpp"
#include "server/program_log/library_lines.hpp"
#include "server/program_log/reasons.hpp"
#ifdef SONARD_GAZEBO_GZ
#include <gz/msgs/pose.pb.h>
#include <gz/msgs/pose_v.pb.h>

#include <gz/transport/Node.hh>
#else
#include <ignition/msgs/pose.pb.h>
#include <ignition/msgs/pose_v.pb.h>

#include <ignition/transport/Node.hh>
#endif

namespace sonard::server {
namespace {

namespace asio = boost::asio;
#ifdef SONARD_GAZEBO_GZ
namespace gazebo = gz;
#else
namespace gazebo = ignition;  // its name before Gazebo Garden
#endif

struct Message {
  std::string type;
  std::string bytes;
  TimePoint arrival;
};

std::optional<std::int64_t> stamp_ns(const gazebo::msgs::Header& header) {
  if (!header.has_stamp()) {
    return std::nullopt;
  }
  // Limited so that nanoseconds do not overflow; EntityMap rejects such a stamp.
  const std::int64_t seconds = std::min<std::int64_t>(header.stamp().sec(), 9'000'000'000);
  return seconds * 1'000'000'000 + header.stamp().nsec();
}

pose::NamedTransform entity(const gazebo::msgs::Pose& pose) {
  const auto& p = pose.position();
  const auto& q = pose.orientation();
  return {pose.name(), {{p.x(), p.y(), p.z()}, {q.w(), q.x(), q.y(), q.z()}}};
}

/// Redirects output of the library and protobuf, which peers can cause as often as they like.
void take_lines_of_the_library() {
  take_library_lines();
#if GOOGLE_PROTOBUF_VERSION < 4022000  // later versions log through Abseil
  google::protobuf::SetLogHandler([](google::protobuf::LogLevel, const char*, int, const std::string& text) {
    log_library_line("libprotobuf", text);
  });
#endif
}

Result<EntityPoses, std::string> parse(const Message& message) {
  const std::string_view name = std::string_view(message.type).substr(message.type.rfind('.') + 1);
  EntityPoses poses;
  if (name == "Pose_V") {
    gazebo::msgs::Pose_V list;
    if (!list.ParseFromString(message.bytes)) {
      return fmt::format("its bytes are not a {}", message.type);
    }
    poses.time_ns = stamp_ns(list.header());
    for (const gazebo::msgs::Pose& pose : list.pose()) {
      poses.entities.push_back(entity(pose));
    }
    return poses;
  }
  if (name == "Pose") {
    gazebo::msgs::Pose pose;
    if (!pose.ParseFromString(message.bytes)) {
      return fmt::format("its bytes are not a {}", message.type);
    }
    poses.time_ns = stamp_ns(pose.header());
    poses.entities.push_back(entity(pose));
    return poses;
  }
  return fmt::format("its type is {} (expected Pose_V or Pose)", message.type);
}

}  // namespace

// Lives as long as any handler queued on the io_context. `waiting`, `crowded` and `stopped` are shared with
// the transport's threads and guarded by `mutex`. Everything else belongs to the I/O thread.
struct GazeboPoseSource::Impl : std::enable_shared_from_this<GazeboPoseSource::Impl> {
  Impl(asio::io_context& context, GazeboPoseInput configured, const Clock& used_clock, PoseSink poses_go_to)
      : io(context),
        input(std::move(configured)),
        clock(used_clock),
        sink(std::move(poses_go_to)),
        entities(input) {}

  void on_message(const char* data, std::size_t size, const std::string& type);
  void take(const Message& message);
  void deliver(const pose::PoseSample& sample, TimePoint arrival);
  void complain(const std::string& problem);
  void drop(const std::string& problem, TimePoint arrival) {
    unreadable.note(arrival, "", problem);
    complain(problem);
  }

  asio::io_context& io;
  GazeboPoseInput input;
  const Clock& clock;
  PoseSink sink;
  EntityMap entities;
  PoseSourceCounters counters;
  Reasons complaints;
  UnreadableMessages unreadable;
  std::mutex mutex;
  int waiting = 0;
  std::uint64_t crowded = 0;
  bool stopped = false;
};

// Runs on a thread of the transport. Reading the clock and queueing under one lock keeps arrivals in order.
void GazeboPoseSource::Impl::on_message(const char* data, std::size_t size, const std::string& type) {
  const std::scoped_lock lock(mutex);
  if (stopped) {
    return;
  }
  if (waiting == max_waiting) {
    ++crowded;
    return;
  }
  ++waiting;
  asio::post(io, [self = shared_from_this(), message = Message{type, {data, size}, clock.now()}] {
    self->take(message);
  });
}

void GazeboPoseSource::Impl::take(const Message& message) {
  std::uint64_t dropped = 0;
  {
    const std::scoped_lock lock(mutex);
    --waiting;
    if (stopped) {
      return;
    }
    dropped = std::exchange(crowded, 0);
  }
  for (; dropped > 0; --dropped) {
    ++counters.refused;
    complain("too many messages wait");
  }
  const auto parsed = parse(message);
  if (!parsed) {
    ++counters.malformed;
    drop(parsed.error(), message.arrival);
    return;
  }
  const auto mapped = entities.map(*parsed);
  if (const std::vector<std::string> ignored = entities.take_ignored(); !ignored.empty()) {
    spdlog::info("pose gazebo {}: ignored entities (not in this world): {}", input.topic,
                 fmt::join(ignored, ", "));
  }
  if (!mapped) {
    ++counters.bad_value;
    drop(mapped.error(), message.arrival);
    return;
  }
  deliver(*mapped, message.arrival);
}

void GazeboPoseSource::Impl::deliver(const pose::PoseSample& sample, TimePoint arrival) {
  if (++counters.samples == 1) {
    const pose::Vec3& p = sample.T_world_vehicle.position_m;
    spdlog::info(
        "pose gazebo {}: the vehicle is entity '{}', first at ({:.3f}, {:.3f}, {:.3f}), time {:.3f} s",
        input.topic, input.vehicle.name, p.x, p.y, p.z, 1e-9 * static_cast<double>(sample.time_ns));
  }
  sink(sample, arrival);
}

void GazeboPoseSource::Impl::complain(const std::string& problem) {
  if (const std::uint64_t count = complaints.count(problem); std::has_single_bit(count)) {
    spdlog::warn("pose gazebo {}: message dropped: {} ({} so far)", input.topic, problem, count);
  }
}

// Destroyed with the source, on the source's thread. On a thread of the transport, its destructor would wait
// for itself.
struct GazeboPoseSource::Subscription {
  explicit Subscription(const gazebo::transport::NodeOptions& options) : node(options) {}
  gazebo::transport::Node node;
};

GazeboPoseSource::GazeboPoseSource(asio::io_context& io, GazeboPoseInput input, const Clock& clock,
                                   PoseSink sink)
    : impl_(std::make_shared<Impl>(io, std::move(input), clock, std::move(sink))) {}

GazeboPoseSource::~GazeboPoseSource() {
  GazeboPoseSource::stop();
}

void GazeboPoseSource::start() {
  const GazeboPoseInput& input = impl_->input;
  gazebo::transport::NodeOptions options;
  if (!input.partition.empty() && !options.SetPartition(input.partition)) {
    throw Error(ErrorKind::network,
                fmt::format("pose gazebo: '{}' is not a valid partition", input.partition), "poses");
  }
  take_lines_of_the_library();
  set_gazebo_address(input.address);
  subscription_ = std::make_unique<Subscription>(options);
  if (is_loopback(input.address)) {
    keep_gazebo_to_this_machine();
  }
  const auto receive = [impl = impl_](const char* data, std::size_t size,
                                      const gazebo::transport::MessageInfo& info) {
    impl->on_message(data, size, info.Type());
  };
  if (!subscription_->node.SubscribeRaw(input.topic, receive)) {
    throw Error(ErrorKind::network, fmt::format("pose gazebo: cannot subscribe to '{}'", input.topic),
                "poses");
  }
}

void GazeboPoseSource::stop() {
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->stopped = true;
  }
  subscription_.reset();
}

std::string GazeboPoseSource::description() const {
  return fmt::format("pose gazebo {} entity '{}'", impl_->input.topic, impl_->input.vehicle.name);
}

std::vector<std::string> GazeboPoseSource::entities() const {
  return impl_->entities.seen();
}

std::string GazeboPoseSource::unreadable(TimePoint now) const {
  return impl_->unreadable.text(now);
}

std::string GazeboPoseSource::silence_hint() const {
  const std::string reach = is_loopback(impl_->input.address)
                                ? "does it run on this machine (another one needs poses.gazebo.address)"
                                : "does multicast reach it";
  return "nothing arrived: is the simulator running, are topic and partition the same as in the simulator, "
         "and " +
         reach + " (docs/simulators/gazebo.md)?";
}

const PoseSourceCounters& GazeboPoseSource::counters() const {
  return impl_->counters;
}

}  // namespace sonard::server
