// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/scanner.hpp"

#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/limits.hpp"
#include "protocol/ping360/make_job.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

using std::chrono::nanoseconds;

/// Up to this delay of the caller the ping rate is kept; longer delays lose time.
constexpr std::chrono::milliseconds lateness_allowed{50};
/// Limits the rate of a scan, which runs for ever, if no ping can be rendered.
constexpr std::chrono::milliseconds least_time_of_failed_ping{10};

}  // namespace

Scanner::Scanner(const DeviceConfig& config, TimePoint power_up, DeviceCounters& counters)
    : config_(config),
      counters_(counters),
      cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, power_up, counters) {
}

void Scanner::restart(TimePoint now) {
  stop(now);
  place(0);
  settings_ = {};
  last_samples_.clear();
}

// ---- Commands

void Scanner::command(TimePoint now, const Peer& asker, const Transducer& command) {
  const bool joins = config_.joins_repeated_commands && is_repeated(asker, command);
  end_scan(now);
  if (joins) {
    ++counters_.commands_joined;
    return;
  }
  queue_.push_back({asker, command, now});
  // If the head is idle, the first command in the queue starts in this step and does not wait.
  const std::size_t starting = work_ && !work_->form.scan ? 0 : 1;
  if (queue_.size() > config_.queue_length + starting) {
    queue_.pop_front();
    ++counters_.commands_dropped;
  }
}

/// Clients repeat a command while the head still turns, and send the next command after each answer. Two
/// answers to one command would make them ping every angle twice for ever.
bool Scanner::is_repeated(const Peer& asker, const Transducer& command) const {
  if (scan_) {
    return false;  // a scan was started after the last command
  }
  const PingForm form = form_of(command);
  const bool transmit = command.transmit != 0;
  const auto last = std::find_if(queue_.rbegin(), queue_.rend(),
                                 [&](const Command& waiting) { return same_client(waiting.asker, asker); });
  if (last != queue_.rend()) {
    return form_of(last->command) == form && (last->command.transmit != 0) == transmit;
  }
  return work_ && same_client(work_->asker, asker) && work_->asked == form && work_->transmit == transmit;
}

void Scanner::scan(TimePoint now, const Peer& starter, const AutoTransmit& command) {
  if (scan_ && same_client(scan_->starter, starter) && scan_->command == command) {
    return;  // clients repeat the command several times per turn
  }
  end_scan(now);
  scan_.emplace(Scan{starter, command,
                     Sweep(scan_angle(command.start_angle, config_), scan_angle(command.stop_angle, config_),
                           command.num_steps, config_.clamps_scan_to_stop),
                     now});
}

/// In playback a ping that has begun is still sent, because it will not be fed again.
void Scanner::end_scan(TimePoint now) {
  scan_.reset();
  if (work_ && work_->form.scan && !(config_.plays_back && cycle_.under_way())) {
    abandon_work(now);
  }
}

void Scanner::stop(TimePoint now) {
  queue_.clear();
  scan_.reset();
  abandon_work(now);
}

void Scanner::forget(TimePoint now, const Peer& client) {
  std::erase_if(queue_, [&](const Command& waiting) { return same_client(waiting.asker, client); });
  if (scan_ && same_client(scan_->starter, client)) {
    scan_.reset();
  }
  if (work_ && same_client(work_->asker, client)) {
    abandon_work(now);
  }
}

void Scanner::feed(const std::optional<ReplayedPing>& ping) {
  cycle_.feed(ping && recorded_form(ping->wire) ? ping : std::nullopt);
}

// ---- Angle

nanoseconds Scanner::scaled(nanoseconds time) const {
  return nanoseconds{static_cast<nanoseconds::rep>(static_cast<double>(time.count()) * config_.time_scale)};
}

int Scanner::position(TimePoint now) const {
  if (now >= turn_end_) {
    return wrapped(from_ + way_);
  }
  const double done = now <= turn_begin_ ? 0.0
                                         : static_cast<double>((now - turn_begin_).count()) /
                                               static_cast<double>((turn_end_ - turn_begin_).count());
  return wrapped(from_ + static_cast<int>(way_ * done));
}

void Scanner::place(int angle) {
  from_ = angle;
  way_ = 0;
  turn_end_ = TimePoint::min();
}

/// Starts a turn the short way at constant speed and returns its duration.
nanoseconds Scanner::turn_to(int angle, TimePoint begin) {
  from_ = position(begin);
  way_ = shortest_turn(from_, angle);
  turn_begin_ = begin;
  const nanoseconds time = scaled(std::abs(way_) * config_.time_per_gradian);
  turn_end_ = begin + time;
  return time;
}

// ---- Work

/// Queued commands come before the scan, because a command ends an earlier scan.
std::optional<Scanner::Work> Scanner::next_work() {
  if (!queue_.empty()) {
    const Command next = queue_.front();
    queue_.pop_front();
    const PingForm form = form_of(next.command);
    return Work{next.asker, form, form, next.command.transmit != 0, next.received};
  }
  if (scan_) {
    const PingForm form = form_of(scan_->command, scan_->sweep.angle());
    return Work{scan_->starter, form, form, true, scan_->next_from};
  }
  return std::nullopt;
}

void Scanner::begin_work() {
  if (work_) {
    return;
  }
  work_ = next_work();
  if (!work_) {
    return;
  }
  settings_ = work_->form.settings;
  work_->there_at = std::max(work_->wanted, busy_until_);
  if (work_->transmit && config_.plays_back) {
    return;  // the recorded ping sets the angle
  }
  const nanoseconds turn = turn_to(settings_.angle, work_->there_at);
  const nanoseconds listen = listening_time(settings_.number_of_samples, settings_.sample_period);
  const nanoseconds delay = std::chrono::milliseconds{work_->form.scan ? work_->form.scan->delay_ms : 0};
  work_->there_at += turn;
  work_->period = std::max(scaled(listen + config_.ping_overhead + delay) + turn, listen);
}

/// @param end when the head is free again by its timing
void Scanner::end_work(TimePoint end) {
  busy_until_ = end;
  if (work_->form.scan && scan_) {
    scan_->sweep.advance();
    scan_->next_from = end;
    if (!config_.simulated_time) {
      scan_->next_from += scaled(std::chrono::milliseconds{scan_->command.delay_ms});
    }
  }
  work_.reset();
}

void Scanner::abandon_work(TimePoint now) {
  if (!work_) {
    return;
  }
  work_.reset();
  cycle_.cancel();
  place(position(now));
  busy_until_ = now;
}

// ---- Pings

std::optional<TimePoint> Scanner::next_start() const {
  if (!work_ || !work_->transmit) {
    return std::nullopt;
  }
  return cycle_.next_start(std::max(work_->wanted, cycle_.answered_at()), work_->there_at);
}

std::optional<TimePoint> Scanner::ping_due() const {
  return cycle_.granted() ? next_start() : std::nullopt;
}

void Scanner::begin_ping(TimePoint now, TimePoint due) {
  const TimePoint transmit_time = std::max(due, now - lateness_allowed);
  const bool fed = cycle_.fed().has_value();
  PingJob job = fed ? repeat(*cycle_.fed()) : make_job(work_->form, config_);
  job.period = work_->period;
  ping_.send_due = transmit_time;
  if (!config_.simulated_time) {
    // In playback a ping is sent when its echoes have arrived; its due time sets the rate.
    ping_.send_due += scaled(job.listening_time + (fed ? nanoseconds{0} : config_.ping_overhead));
  }
  cycle_.begin(std::move(job), transmit_time);
}

/// Uses the recorded settings, but the client's mode and scan, because clients expect them back.
PingJob Scanner::repeat(const ReplayedPing& fed) {
  const PingForm form = recorded_form(fed.wire).value();
  PingJob job = make_job(fed, form, config_);
  job.differences = differences(work_->form, job, form);
  const std::uint8_t mode = work_->form.settings.mode;
  settings_ = form.settings;
  settings_.mode = mode;
  work_->form.settings = settings_;
  place(wrapped(settings_.angle));
  return job;
}

void Scanner::on_image(TimePoint now, const PingImage& image) {
  if (!cycle_.on_image(now, image.number)) {
    return;
  }
  if (image.u8.empty() || image.u8.size() != static_cast<std::size_t>(cycle_.job().bins())) {
    cycle_.fail();
    end_failed_work(now);
    return;
  }
  ping_.samples = image.u8;
}

void Scanner::on_image_failed(TimePoint now, std::uint64_t number) {
  if (cycle_.on_image_failed(now, number)) {
    end_failed_work(now);
  }
}

void Scanner::end_failed_work(TimePoint now) {
  end_work(std::max(ping_.send_due, now + least_time_of_failed_ping));
}

void Scanner::send_ping(std::uint8_t id, std::vector<Answer>& out) {
  PingRecord record = line_record(cycle_.job());
  record.samples = ping_.samples;
  record.wire = recorded_wire(work_->form, id);
  cycle_.put_on_wire(std::move(record));
  out.push_back({work_->asker, encode(message_of(work_->form, ping_.samples), id)});
  ++counters_.pings_sent;
  last_settings_ = work_->form.settings;
  last_samples_ = std::move(ping_.samples);
  if (work_->form.scan && scan_) {
    scan_->has_pinged = true;
  }
  end_work(ping_.send_due);
}

// ---- Time

void Scanner::advance(TimePoint now, std::uint8_t id, std::vector<Answer>& out) {
  if (cycle_.rendered() && now >= ping_.send_due) {
    send_ping(id, out);
  }
  for (begin_work(); work_ && !work_->transmit && now >= work_->there_at; begin_work()) {
    out.push_back({work_->asker, encode(message_of(work_->form, {}), id)});
    last_samples_.clear();
    end_work(work_->there_at);
  }
  if (const auto due = ping_due(); due && now >= *due) {
    begin_ping(now, *due);
  }
}

std::optional<TimePoint> Scanner::next_deadline() const {
  if (cycle_.under_way()) {
    return cycle_.rendered() ? std::optional{ping_.send_due} : std::nullopt;
  }
  return work_ && !work_->transmit ? std::optional{work_->there_at} : ping_due();
}

void Scanner::report(Actions& actions) {
  cycle_.report(actions);
  if (const auto start = next_start()) {
    const DeviceData& settings = work_->form.settings;
    actions.next_ping =
        NextPing{*start, work_->period, listening_time(settings.number_of_samples, settings.sample_period)};
  }
}

DeviceData Scanner::state(TimePoint now) const {
  DeviceData state = last_settings_;
  state.data = last_samples_;
  if (last_samples_.empty()) {
    state = settings_;
    state.angle = static_cast<std::uint16_t>(position(now));
  }
  return state;
}

std::optional<AutoDeviceData> Scanner::scan_state(TimePoint now) const {
  if (!scan_) {
    return std::nullopt;
  }
  AutoDeviceData state;
  copy_ping_settings(state, scan_->command);
  copy_scan_settings(state, scan_->command);
  state.angle = static_cast<std::uint16_t>(position(now));
  if (scan_->has_pinged) {
    state.angle = last_settings_.angle;
    state.data = last_samples_;
  }
  return state;
}

std::optional<std::pair<Peer, AutoTransmit>> Scanner::running_scan() const {
  return scan_ ? std::optional(std::pair{scan_->starter, scan_->command}) : std::nullopt;
}

}  // namespace sonard::ping360
