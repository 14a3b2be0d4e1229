// SPDX-License-Identifier: Apache-2.0
#include "server/pose/trajectory/source.hpp"

#include <spdlog/spdlog.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <utility>

namespace sonard::server {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

constexpr std::chrono::nanoseconds period = std::chrono::milliseconds{10};

}  // namespace

struct TrajectoryPoseSource::Impl : std::enable_shared_from_this<TrajectoryPoseSource::Impl> {
  Impl(asio::io_context& io, pose::Trajectory played, TrajectoryInput configured, const Clock& used_clock,
       PoseSink poses_go_to)
      : input(std::move(configured)),
        trajectory(std::move(played)),
        playback{input.speed, input.loop, 0},
        clock(used_clock),
        sink(std::move(poses_go_to)),
        timer(io) {}

  void tick();

  TrajectoryInput input;
  pose::Trajectory trajectory;
  pose::Playback playback;
  const Clock& clock;
  PoseSink sink;
  asio::steady_timer timer;
  bool running = false;
  TimePoint started{};
  PoseSourceCounters counters;
};

void TrajectoryPoseSource::Impl::tick() {
  if (!running) {
    return;
  }
  const TimePoint now = clock.now();
  pose::PoseSample sample = pose::play(trajectory, playback, now - started);
  sample.time_ns = now.count();
  ++counters.samples;
  sink(sample, now);
  if (pose::finished(trajectory, playback, now - started)) {
    spdlog::info("pose trajectory {}: ended; the vehicle stays at its last pose", input.file.string());
    return;
  }
  timer.expires_after(period);
  timer.async_wait([self = shared_from_this()](const error_code& cancelled) {
    if (!cancelled) {
      self->tick();
    }
  });
}

TrajectoryPoseSource::TrajectoryPoseSource(asio::io_context& io, pose::Trajectory trajectory,
                                           TrajectoryInput input, const Clock& clock, PoseSink sink)
    : impl_(std::make_shared<Impl>(io, std::move(trajectory), std::move(input), clock, std::move(sink))) {}

TrajectoryPoseSource::~TrajectoryPoseSource() {
  stop();
}

void TrajectoryPoseSource::start() {
  impl_->running = true;
  impl_->started = impl_->clock.now();
  impl_->tick();
}

void TrajectoryPoseSource::stop() {
  impl_->running = false;
  impl_->timer.cancel();
}

std::string TrajectoryPoseSource::description() const {
  return "pose trajectory " + impl_->input.file.string();
}

const PoseSourceCounters& TrajectoryPoseSource::counters() const {
  return impl_->counters;
}

}  // namespace sonard::server
