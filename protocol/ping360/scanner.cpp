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

Scanner::Scanner(const DeviceConfig& config, DeviceCounters& counters)
    : config_(config), counters_(counters) {}

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
  if (work_ && work_->form.scan && !(config_.plays_back && ping_)) {
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
  const auto form = ping ? recorded_form(ping->wire) : std::nullopt;
  fed_ = form ? std::optional(FedPing{*ping, *form}) : std::nullopt;
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
  ping_.reset();
}

void Scanner::abandon_work(TimePoint now) {
  if (!work_) {
    return;
  }
  if (ping_) {
    ++counters_.pings_cancelled;
  }
  work_.reset();
  ping_.reset();
  job_.reset();
  place(position(now));
  busy_until_ = now;
}

// ---- Pings

std::optional<TimePoint> Scanner::ping_possible() const {
  if (!work_ || !work_->transmit || ping_ || unanswered_ || (config_.plays_back && !fed_)) {
    return std::nullopt;
  }
  const TimePoint possible = std::max(work_->wanted, free_since_);
  if (config_.simulated_time) {
    return possible;  // the server observes the ping rate in simulated time
  }
  const TimePoint due = std::max(possible, work_->there_at);
  return fed_ ? std::max(due, fed_->ping.due.value_or(due)) : due;
}

std::optional<NextPing> Scanner::next_ping() const {
  const auto possible = ping_possible();
  if (!possible) {
    return std::nullopt;
  }
  const DeviceData& settings = work_->form.settings;
  return NextPing{*possible, work_->period,
                  listening_time(settings.number_of_samples, settings.sample_period)};
}

std::optional<TimePoint> Scanner::ping_due() const {
  return config_.simulated_time && !due_ ? std::nullopt : ping_possible();
}

void Scanner::start_ping(TimePoint now, TimePoint due) {
  due_ = false;
  const TimePoint transmit_time = std::max(due, now - lateness_allowed);
  const auto fed = std::exchange(fed_, std::nullopt);
  PingJob job = fed ? repeat(*fed) : make_job(work_->form, config_);
  job.period = work_->period;
  Ping ping;
  ping.number = job.number = next_ping_number_++;
  ping.transmit_time = job.transmit_time = ping.send_due = transmit_time;
  if (!config_.simulated_time) {
    // In playback a ping is sent when its echoes have arrived; its due time sets the rate.
    ping.send_due += scaled(job.listening_time + (fed ? nanoseconds{0} : config_.ping_overhead));
  }
  ping.settings = {.bins = job.bins(),
                   .beams = 1,
                   .bin_m = job.bin_m(),
                   .sound_speed_mps = job.sound_speed_mps,
                   .gain_percent = job.gain_percent,
                   .frequency_hz = 1e3 * settings_.transmit_frequency_khz};
  ping.bearing_rad = job.bearing_rad;
  ping_ = std::move(ping);
  job_ = std::move(job);
  ++counters_.pings_started;
}

/// Uses the recorded settings, but the client's mode and scan, because clients expect them back.
PingJob Scanner::repeat(const FedPing& fed) {
  PingJob job = make_job(fed.ping, fed.form, config_);
  job.differences = differences(work_->form, job, fed.form);
  const std::uint8_t mode = work_->form.settings.mode;
  settings_ = fed.form.settings;
  settings_.mode = mode;
  work_->form.settings = settings_;
  place(wrapped(settings_.angle));
  return job;
}

std::optional<PingJob> Scanner::take_job() {
  auto job = std::exchange(job_, std::nullopt);
  if (job) {
    unanswered_ = job->number;
  }
  return job;
}

/// Marks the job as answered; true if it belongs to the acquired ping.
bool Scanner::answered(TimePoint now, std::uint64_t number) {
  if (unanswered_ != number) {
    ++counters_.stale_images;
    return false;
  }
  unanswered_.reset();
  free_since_ = now;
  return ping_ && ping_->number == number;
}

void Scanner::on_image(TimePoint now, const PingImage& image) {
  if (!answered(now, image.number)) {
    return;
  }
  if (image.u8.empty() || image.u8.size() != static_cast<std::size_t>(ping_->settings.bins)) {
    fail_ping(now);
    return;
  }
  ping_->samples = image.u8;
}

void Scanner::on_image_failed(TimePoint now, std::uint64_t number) {
  if (answered(now, number)) {
    fail_ping(now);
  }
}

void Scanner::fail_ping(TimePoint now) {
  ++counters_.pings_failed;
  end_work(std::max(ping_->send_due, now + least_time_of_failed_ping));
}

void Scanner::keep_record(std::uint8_t id) {
  PingRecord record;
  record.number = ping_->number;
  record.transmit_time = ping_->transmit_time;
  record.settings = ping_->settings;
  record.bearings_rad = {ping_->bearing_rad};
  record.samples = ping_->samples;
  record.wire = recorded_wire(work_->form, id);
  record_ = std::move(record);
}

void Scanner::send_ping(std::uint8_t id, std::vector<Answer>& out) {
  keep_record(id);
  out.push_back({work_->asker, encode(message_of(work_->form, ping_->samples), id)});
  ++counters_.pings_sent;
  last_settings_ = work_->form.settings;
  last_samples_ = std::move(ping_->samples);
  if (work_->form.scan && scan_) {
    scan_->has_pinged = true;
  }
  end_work(ping_->send_due);
}

// ---- Time

void Scanner::advance(TimePoint now, std::uint8_t id, std::vector<Answer>& out) {
  if (ping_ && !ping_->samples.empty() && now >= ping_->send_due) {
    send_ping(id, out);
  }
  for (begin_work(); work_ && !work_->transmit && now >= work_->there_at; begin_work()) {
    out.push_back({work_->asker, encode(message_of(work_->form, {}), id)});
    last_samples_.clear();
    end_work(work_->there_at);
  }
  if (const auto due = ping_due(); due && now >= *due) {
    start_ping(now, *due);
  }
}

std::optional<TimePoint> Scanner::next_deadline() const {
  if (ping_) {
    return ping_->samples.empty() ? std::nullopt : std::optional{ping_->send_due};
  }
  return work_ && !work_->transmit ? std::optional{work_->there_at} : ping_due();
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
