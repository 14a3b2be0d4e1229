// SPDX-License-Identifier: Apache-2.0
#include "clients/posecast/caster.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cmath>
#include <utility>

namespace sonard::client {

namespace asio = boost::asio;
using std::chrono::nanoseconds;
using std::chrono::steady_clock;

struct Caster::Impl {
  Impl(asio::io_context& io, const pose::Trajectory& played, const CastSettings& used, PoseLink& way)
      : trajectory(played), settings(used), link(way), timer(io) {}

  nanoseconds time_of_tick(std::int64_t number) const {
    return nanoseconds{std::llround(static_cast<double>(number) * 1e9 / settings.rate_hz)};
  }
  void run_tick();
  void wait_for_next_tick();

  const pose::Trajectory& trajectory;
  CastSettings settings;
  PoseLink& link;
  asio::steady_timer timer;
  steady_clock::time_point begin;
  std::int64_t tick = 0;
  std::function<void()> on_end;
};

void Caster::Impl::run_tick() {
  const nanoseconds elapsed = time_of_tick(tick);
  pose::PoseSample sample = pose::play(trajectory, settings.playback, elapsed);
  sample.time_ns = nanoseconds{begin.time_since_epoch()}.count() + elapsed.count();
  if (!settings.twist) {
    sample.twist.reset();
  }
  link.send(sample);
  wait_for_next_tick();
}

void Caster::Impl::wait_for_next_tick() {
  const bool played = pose::finished(trajectory, settings.playback, time_of_tick(tick));
  const double passed_s = std::chrono::duration<double>(steady_clock::now() - begin).count();
  tick = std::max(tick + 1, static_cast<std::int64_t>(std::ceil(passed_s * settings.rate_hz)));
  if (played || (settings.duration && time_of_tick(tick) >= *settings.duration)) {
    on_end();
    return;
  }
  timer.expires_at(begin + time_of_tick(tick));
  timer.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      run_tick();
    }
  });
}

Caster::Caster(asio::io_context& io, const pose::Trajectory& trajectory, const CastSettings& settings,
               PoseLink& link)
    : impl_(std::make_unique<Impl>(io, trajectory, settings, link)) {}

Caster::~Caster() = default;

void Caster::start(std::function<void()> on_end) {
  impl_->on_end = std::move(on_end);
  impl_->begin = steady_clock::now();
  impl_->run_tick();
}

}  // namespace sonard::client
