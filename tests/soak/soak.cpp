// SPDX-License-Identifier: Apache-2.0
#include "tests/soak/soak.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace sonard::soak {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t pings_of_a_visit = 300;  // more than a Gemini has IDs
constexpr std::uint64_t fails_each = 997;
constexpr std::chrono::nanoseconds render_time = 2ms;

/// Arbitrary values that differ between pings and samples.
std::vector<std::uint8_t> samples_of(const PingJob& job, int beams) {
  std::vector<std::uint8_t> samples(static_cast<std::size_t>(job.bins()) * static_cast<std::size_t>(beams));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i] = static_cast<std::uint8_t>(job.number * 31 + i * 7);
  }
  return samples;
}

bool right(const SeenPing::Stamp& stamp, TimePoint transmit_time) {
  const std::int64_t time =
      stamp.modulus_ns > 0 ? transmit_time.count() % stamp.modulus_ns : transmit_time.count();
  return std::abs(time - stamp.ns) < stamp.resolution_ns;
}

}  // namespace

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::runtime_error(what);
  }
}

DirectionRanges echoes_of(const std::vector<std::uint8_t>& samples, const Directions& directions) {
  DirectionRanges echoes{directions.columns, directions.rows, {}, {}};
  for (std::size_t i = 0; i < directions.count(); ++i) {
    const std::uint8_t sample = samples.at(i % samples.size());
    echoes.range_m.push_back(1.0F + 0.05F * static_cast<float>(sample));
    echoes.intensity.push_back(1e-6F * static_cast<float>(sample));
  }
  return echoes;
}

Soak::Soak(HeadUnderSoak& head) : head_(head) {}

void Soak::run_until(std::uint64_t pings) {
  try {
    // The number of steps without a ping shows that a head no longer pings.
    constexpr std::uint64_t most_steps_each_ping = 10'000;
    std::uint64_t steps = 0;
    for (std::uint64_t before = pings_; pings_ < pings; ++steps) {
      if (std::exchange(before, pings_) != pings_) {
        steps = 0;
      }
      require(steps < most_steps_each_ping, "pings go on");
      advance();
    }
  } catch (const std::exception& wrong) {
    throw std::runtime_error(fmt::format("after {} pings, {} visits and {:.3f} s, this does not hold: {}",
                                         pings_, visits_, std::chrono::duration<double>(now_).count(),
                                         wrong.what()));
  }
}

void Soak::advance() {
  TimePoint next = visitor_ ? TimePoint::max() : next_visit_;
  for (const auto& due : {wake_at_, work_ ? std::optional(work_->done) : std::nullopt,
                          visitor_ ? visitor_->next_deadline() : std::nullopt}) {
    next = std::min(next, due.value_or(TimePoint::max()));
  }
  require(next != TimePoint::max(), "something is due");
  now_ = std::max(now_, next);
  if (work_ && work_->done <= now_) {
    answer();
  } else if (!visitor_ && next_visit_ <= now_) {
    come();
  } else {
    step(TimePassed{});
  }
  if (visitor_) {
    for (const Event& said : visitor_->advance(now_)) {
      step(said);
    }
    for (const SeenPing& ping : visitor_->take_pings()) {
      see(ping);
    }
    if (seen_in_visit_ >= pings_of_a_visit) {
      leave();
    }
  }
}

void Soak::come() {
  visitor_ = head_.visitor(visits_++, now_);
  seen_in_visit_ = 0;
  last_seen_.reset();
  for (const Event& event : visitor_->come()) {
    step(event);
  }
}

/// The next visitor comes at once, or after all timeouts of this one.
void Soak::leave() {
  const std::vector<Event> last_words = visitor_->leave();
  visitor_.reset();
  for (const Event& event : last_words) {
    step(event);
  }
  next_visit_ = now_ + (visits_ % 2 == 0 ? 0s : 7s) + 1234567ns;
}

void Soak::step(const Event& event) {
  Actions actions = head_.device().step(now_, event);
  require(!actions.wake_at || *actions.wake_at > now_, "a wake-up lies in the future");
  wake_at_ = actions.wake_at;
  for (const Outgoing& message : actions.send) {
    head_.check(now_, message);
    if (visitor_) {
      visitor_->hear(now_, message);
    }
  }
  if (actions.record) {
    require(actions.record->number == rendered_.number, "a record has the number of its job");
    require(actions.record->transmit_time == rendered_.transmit_time, "a record has the time of its job");
    require(actions.record->samples == rendered_.samples, "a record has the samples of its image");
  }
  if (actions.cancelled && work_) {
    require(*actions.cancelled == work_->job.number, "what is cancelled is out");
    work_->wanted = false;
  }
  if (actions.render) {
    check_job(*actions.render);
    work_ = Work{std::move(*actions.render), now_ + render_time};
    ++next_job_;
  }
}

void Soak::check_job(const PingJob& job) const {
  require(!work_, "one job at a time");
  require(job.number == next_job_, "jobs are numbered");
  require(job.transmit_time == now_, "a ping is asked for when it is transmitted");
  require(job.transmit_us == static_cast<std::uint64_t>(now_ / 1us), "its stamp is that time");
}

void Soak::answer() {
  const Work work = *std::exchange(work_, std::nullopt);
  if (!work.wanted || work.job.number % fails_each == fails_each - 1) {
    last_seen_.reset();
    step(PingNotRendered{work.job.number});
    return;
  }
  const std::vector<std::uint8_t> image = samples_of(work.job, head_.beams());
  rendered_ = {work.job.number, work.job.transmit_time, head_.made_of(image)};
  PingImage answer{work.job.number, image, {}};
  if (work.job.directions.any()) {
    answer.directions = echoes_of(image, work.job.directions);
  }
  step(PingRendered{std::move(answer)});
}

void Soak::see(const SeenPing& ping) {
  require(ping.samples == rendered_.samples, "a ping has the samples that were rendered");
  require(!ping.stamp || right(*ping.stamp, rendered_.transmit_time), "a ping has the time of its job");
  // The head may have begun the first ping for the previous client.
  if (last_seen_ && seen_in_visit_ > 1) {
    require(ping.id == (last_seen_->id + head_.id_step()) % head_.id_modulus(),
            "a ping follows the last one");
    const auto period = head_.period();
    require(!period || rendered_.transmit_time - last_transmit_ == *period, "pings keep their period");
  }
  last_seen_ = ping;
  last_transmit_ = rendered_.transmit_time;
  ++seen_in_visit_;
  ++pings_;
}

}  // namespace sonard::soak
