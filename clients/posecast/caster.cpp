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
  /// Real time from the first tick to this one.
  nanoseconds due(std::int64_t number) const {
    const double pace = settings.stamps_of_file ? settings.playback.speed : 1.0;
    return nanoseconds{std::llround(static_cast<double>(number) * 1e9 / (settings.rate_hz * pace))};
  }
  pose::Playback playback() const {
    pose::Playback playback = settings.playback;
    if (settings.stamps_of_file) {
      playback.speed = 1.0;
    }
    return playback;
  }
  void send(nanoseconds elapsed);
  void run_tick();
  void hold_until(steady_clock::time_point end);
  void wait_for_next_tick();
  void wait_until(steady_clock::time_point time, std::function<void()> then);

  const pose::Trajectory& trajectory;
  CastSettings settings;
  PoseLink& link;
  asio::steady_timer timer;
  steady_clock::time_point begin;
  std::int64_t tick = 0;
  std::function<void()> on_end;
};

void Caster::Impl::send(nanoseconds elapsed) {
  pose::PoseSample sample = pose::play(trajectory, playback(), elapsed);
  sample.time_ns =
      elapsed.count() + (settings.stamps_of_file ? trajectory.start_ns() + settings.playback.from_ns
                                                 : nanoseconds{begin.time_since_epoch()}.count());
  if (!settings.twist) {
    sample.twist.reset();
  }
  link.send(sample);
}

void Caster::Impl::run_tick() {
  send(time_of_tick(tick));
  if (settings.stamps_of_file) {
    link.when_sent([this] { wait_for_next_tick(); });
  } else {
    wait_for_next_tick();
  }
}

void Caster::Impl::hold_until(steady_clock::time_point end) {
  begin = steady_clock::now();
  if (begin >= end) {
    run_tick();
    return;
  }
  send(nanoseconds{0});
  link.when_sent([this, end] { wait_until(begin + due(1), [this, end] { hold_until(end); }); });
}

void Caster::Impl::wait_for_next_tick() {
  const bool played = pose::finished(trajectory, playback(), time_of_tick(tick));
  ++tick;
  if (!settings.stamps_of_file) {
    const double passed_s = std::chrono::duration<double>(steady_clock::now() - begin).count();
    tick = std::max(tick, static_cast<std::int64_t>(std::ceil(passed_s * settings.rate_hz)));
  }
  if (played || (settings.duration && time_of_tick(tick) >= *settings.duration)) {
    on_end();
    return;
  }
  wait_until(begin + due(tick), [this] { run_tick(); });
}

void Caster::Impl::wait_until(steady_clock::time_point time, std::function<void()> then) {
  timer.expires_at(time);
  timer.async_wait([then = std::move(then)](const boost::system::error_code& cancelled) {
    if (!cancelled) {
      then();
    }
  });
}

Caster::Caster(asio::io_context& io, const pose::Trajectory& trajectory, const CastSettings& settings,
               PoseLink& link)
    : impl_(std::make_unique<Impl>(io, trajectory, settings, link)) {}

Caster::~Caster() = default;

void Caster::start(std::function<void()> on_end) {
  impl_->on_end = std::move(on_end);
  impl_->hold_until(steady_clock::now() + impl_->settings.hold);
}

}  // namespace sonard::client
