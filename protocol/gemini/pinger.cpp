// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/pinger.hpp"

#include <algorithm>
#include <utility>

#include "protocol/gemini/recorded_form.hpp"

namespace sonard::gemini {

namespace {

// A ping that starts at most this late gets its due time as transmit time, so that host timers do not slow
// down the ping rate. A ping that starts later gets the current time.
constexpr std::chrono::nanoseconds start_slack = std::chrono::milliseconds{5};

std::optional<TimePoint> earlier(std::optional<TimePoint> a, std::optional<TimePoint> b) {
  return a && b ? std::min(a, b) : (a ? a : b);
}

bool due(const std::optional<TimePoint>& time, TimePoint now) {
  return time && *time <= now;
}

}  // namespace

Pinger::Pinger(const DeviceConfig& config, DeviceCounters& counters, TimePoint boot_time)
    : config_(config),
      counters_(counters),
      boot_time_(boot_time),
      pacer_(config.line_period, config.burst_lines),
      earliest_start_(boot_time),
      cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, boot_time,
             counters) {}

// ---- Wanted
// -----------------------------------------------------------------------------------------------------

void Pinger::feed(const std::optional<ReplayedPing>& ping) {
  cycle_.feed(ping && recorded_form(ping->settings) ? ping : std::nullopt);
}

void Pinger::configure(TimePoint now, const PingConfig& config) {
  if (single_) {
    ++counters_.configs_replaced;
  }
  single_.reset();
  programme_.reset();
  pings_out_of_water_ = config.pings_out_of_water();
  if (cycle_.under_way() && cycle_.job().transmit_time > now) {
    // This ping is being rendered ahead of its transmit time. The client has not seen it, so replace it.
    earliest_start_ = ping_.earliest_start_before;
    cycle_.cancel();
  }
  const std::optional<PingPlan> plan = plan_ping(config, config_);
  if (!plan) {
    ++counters_.unsupported_data;
  } else if (plan->mode == RunMode::single) {
    single_ = Wanted{*plan, now};
  } else {
    programme_ = plan;
    programme_due_ = now;
  }
}

void Pinger::on_trigger(TimePoint now) {
  if (!programme_ || programme_->mode != RunMode::external_trigger) {
    return;
  }
  // A busy head drops the edge and does not ping for it later.
  const bool too_early = now < earliest_start_ && !config_.simulated_time;
  if (suspended_ || single_ || cycle_.busy() || sending() || too_early) {
    ++counters_.pings_suppressed;
    return;
  }
  single_ = Wanted{*programme_, now};
}

void Pinger::stop() {
  single_.reset();
  programme_.reset();
  cycle_.cancel();
}

void Pinger::suspend() {
  suspended_ = true;
  single_.reset();
  cycle_.cancel();
  drop_retries(transmission_ ? transmission_->ping().line_count() : 0);
  if (sending()) {
    ++counters_.pings_cancelled;
    transmission_.reset();
  }
}

void Pinger::resume(TimePoint now) {
  if (suspended_) {
    suspended_ = false;
    programme_due_ = now;
  }
}

void Pinger::reset(TimePoint boot_time) {
  stop();
  suspended_ = false;
  pings_out_of_water_ = false;
  counters_.pings_cancelled += sending() ? 1 : 0;
  transmission_.reset();
  drop_retries(0);
  boot_time_ = boot_time;
  cycle_.reboot(boot_time);
  earliest_start_ = boot_time;
  pacer_ = Pacer(config_.line_period, config_.burst_lines);
}

// ---- Under way
// --------------------------------------------------------------------------------------------------

const PingPlan* Pinger::wanted_plan() const {
  if (single_) {
    return &single_->plan;
  }
  return programme_ && programme_->mode == RunMode::continuous ? &*programme_ : nullptr;
}

// Minimum time between two starts by the rate rules (8.4): the listening time and the head's own minimum.
std::chrono::nanoseconds Pinger::period_of(const PingPlan& plan) const {
  return std::max(config_.min_ping_period, plan.job.listening_time);
}

// Time from a ping that begins now to the next requested one.
std::chrono::nanoseconds Pinger::wanted_period(const PingPlan& plan) const {
  return single_ ? period_of(plan) : std::max(plan.interval, period_of(plan));
}

// Transmit time of the next ping, not before the previous tail was sent. nullopt if no ping can start or is
// wanted.
std::optional<TimePoint> Pinger::next_start() const {
  if (suspended_ || wanted_plan() == nullptr) {
    return std::nullopt;
  }
  const TimePoint wanted = single_ ? single_->asked_at : boot_time_;
  const TimePoint by_rate = single_ ? earliest_start_ : std::max(programme_due_, earliest_start_);
  const std::optional<TimePoint> time = cycle_.next_start(wanted, by_rate);
  if (!time || !transmission_) {
    return time;
  }
  if (!sending()) {
    return std::max(*time, transmission_->tail_sent_at().value_or(*time));
  }
  // Pacing is deterministic, so the end of the ping on the wire is known in advance.
  return config_.render_lead.count() > 0
             ? std::optional(std::max(*time, transmission_->predicted_end(pacer_)))
             : std::nullopt;
}

std::optional<TimePoint> Pinger::ping_due() const {
  const auto start = cycle_.granted() ? next_start() : std::nullopt;
  return start ? std::optional(*start - config_.render_lead) : std::nullopt;
}

void Pinger::begin_ping(TimePoint now) {
  const std::optional<ReplayedPing>& fed = cycle_.fed();
  const PingPlan asked = *wanted_plan();
  const PingPlan plan = fed ? held_to(*fed, asked, config_) : asked;
  TimePoint transmit_time = *next_start();
  if (now - transmit_time > start_slack) {
    transmit_time = now;
  }
  const std::chrono::nanoseconds period = wanted_period(asked);
  const TimePoint asked_at = single_ ? single_->asked_at : transmit_time;
  if (single_) {
    single_.reset();
  } else {
    programme_due_ = transmit_time + std::max(plan.interval, config_.min_ping_period);
  }
  if (out_of_water_ && !plan.pings_out_of_water) {
    ++counters_.pings_suppressed;
    cycle_.skip();
    return;
  }
  ping_ = Ping{.plan = plan,
               .asked_at = asked_at,
               .earliest_start_before = earliest_start_,
               .gain_percent = asked.job.gain_percent};
  earliest_start_ = transmit_time + period_of(plan);
  PingJob job = asked.job;
  job.period = period;
  if (fed) {
    job.differences = differences(asked, plan, fed->settings);
    if (fed->settings.gain_percent >= 0.0) {
      ping_.gain_percent = fed->settings.gain_percent;
    }
  }
  cycle_.begin(std::move(job), transmit_time);
}

void Pinger::on_image(TimePoint now, const PingImage& image) {
  if (!cycle_.on_image(now, image.number)) {
    return;
  }
  if (!fits(image, ping_.plan.job)) {
    cycle_.fail();
    return;
  }
  PingHead head = ping_.plan.head;
  head.ping_id = static_cast<std::uint16_t>(image.number & 0xFF);  // later clients need 0..255 (6.3)
  head.transmit_time_us = cycle_.job().transmit_us;
  ping_.encoded.emplace(head, ping_.plan.line_scale, image);
  ping_.record = record_of(head, image);
  ping_.record.settings.gain_percent = ping_.gain_percent;
}

// ---- On the wire
// ------------------------------------------------------------------------------------------------

// A new head waits while the client still repairs the last ping (7.3): while requests are queued, and for
// retry_hold after the last request. If the client requested its next single ping after its last retry
// request, it has finished the old ping; then the head waits only for the queued requests.
std::optional<TimePoint> Pinger::head_due() const {
  if (!cycle_.rendered() || sending()) {
    return std::nullopt;
  }
  TimePoint free = std::max(cycle_.job().transmit_time, cycle_.answered_at());
  if (!transmission_) {
    return free;
  }
  free = std::max(free, transmission_->tail_sent_at().value_or(free));
  const TimePoint longest = free + config_.retry_hold_max;
  if (!retries_.empty()) {
    return longest;
  }
  const bool repairing =
      last_retry_activity_ &&
      !(ping_.plan.mode == RunMode::single && ping_.asked_at >= last_retry_arrival_.value_or(ping_.asked_at));
  return repairing ? std::clamp(*last_retry_activity_ + config_.retry_hold, free, longest) : free;
}

void Pinger::put_on_wire() {
  // Requests have no ping ID. Serving one for the old ping now would make the client request all of the new
  // one.
  drop_retries(ping_.encoded->line_count());
  last_retry_arrival_.reset();
  last_retry_activity_.reset();
  cycle_.put_on_wire(std::move(ping_.record));
  transmission_.emplace(std::move(*ping_.encoded), cycle_.job().transmit_time,
                        ping_.plan.job.compression_log2);
}

void Pinger::send_lines(TimePoint now, std::vector<SharedBytes>& out) {
  if (!sending()) {
    return;
  }
  const int before = transmission_->lines_sent();
  transmission_->send(now, pacer_, out);
  counters_.lines_sent += static_cast<std::uint64_t>(transmission_->lines_sent() - before);
  counters_.pings_sent += transmission_->finished() ? 1 : 0;
}

void Pinger::on_retry(TimePoint now, const RetryRequest& request) {
  ++counters_.retries_received;
  if (!transmission_ || !retries_.push(request)) {
    ++counters_.retries_dropped;
    return;
  }
  last_retry_arrival_ = now;
  last_retry_activity_ = now;
}

void Pinger::serve_retries(TimePoint now, std::vector<SharedBytes>& out) {
  // A tail resent in the middle of a ping would make the client request all remaining lines.
  if (!transmission_ || sending()) {
    return;
  }
  while (pacer_.ready(now)) {
    const auto what = retries_.pop();
    if (!what) {
      return;
    }
    out.push_back(resend(*what));
    pacer_.sent(now);
    last_retry_activity_ = now;
  }
}

SharedBytes Pinger::resend(const RetryQueue::Resend& what) {
  const EncodedPing& ping = transmission_->ping();
  switch (what.kind) {
    case RetryKind::head:
      ++counters_.heads_resent;
      return ping.resent_head();
    case RetryKind::lines:
      ++counters_.lines_resent;
      return ping.resent_line(what.line);
    case RetryKind::tail:
      break;
  }
  ++counters_.tails_resent;
  return ping.resent_tail();
}

void Pinger::drop_retries(int line_count) {
  counters_.retries_dropped += retries_.size();
  retries_.reset(line_count);
}

// ---- Time
// -------------------------------------------------------------------------------------------------------

void Pinger::advance(TimePoint now, std::vector<SharedBytes>& out) {
  for (bool progress = true; progress;) {
    progress = false;
    send_lines(now, out);
    serve_retries(now, out);
    if (due(ping_due(), now)) {
      begin_ping(now);
      progress = true;
    }
    if (due(head_due(), now)) {
      put_on_wire();
      progress = true;
    }
  }
}

std::optional<TimePoint> Pinger::datagram_due() const {
  if (sending()) {
    return transmission_->next_send(pacer_);
  }
  if (!transmission_ || retries_.empty()) {
    return std::nullopt;
  }
  return pacer_.earliest(retries_.pending(pacer_.wake_batch()));
}

std::optional<TimePoint> Pinger::next_deadline() const {
  return earlier(datagram_due(), earlier(ping_due(), head_due()));
}

void Pinger::report(Actions& actions) {
  cycle_.report(actions);
  if (const auto start = next_start()) {
    const PingPlan& plan = *wanted_plan();
    actions.next_ping = NextPing{*start - config_.render_lead, wanted_period(plan), plan.job.listening_time};
  }
}

}  // namespace sonard::gemini
