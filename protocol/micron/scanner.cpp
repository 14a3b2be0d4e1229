// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/scanner.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/line_job.hpp"
#include "protocol/micron/recorded_form.hpp"

namespace sonard::micron {
namespace {

using std::chrono::nanoseconds;

/// Up to this delay of the caller the line rate is kept; longer delays lose time.
constexpr std::chrono::milliseconds lateness_allowed{50};

}  // namespace

Scanner::Scanner(const DeviceConfig& config, TimePoint power_up, DeviceCounters& counters)
    : config_(config),
      counters_(counters),
      motor_(bearing_ahead),
      sweep_(config.limits_order),
      cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, power_up, counters) {
}

void Scanner::restart(TimePoint now, TimePoint begin) {
  cycle_.cancel();
  parameters_.reset();
  motor_error_ = false;
  owed_ = 0;
  placed_ = false;
  motor_.place(motor_.position(now));
  const double way_rad = std::abs(bearing_rad(motor_.position(now)));
  const nanoseconds seek{static_cast<nanoseconds::rep>(way_rad / config_.seek_speed_rad_s * 1e9)};
  motor_.turn_to(bearing_ahead, begin, begin + seek);
  centred_at_ = begin + std::max(config_.least_centring_time, seek);
}

// ---- Commands

void Scanner::configure(TimePoint now, const HeadCommand& parameters) {
  settle(now);
  if (!config_.plays_back) {
    cycle_.cancel();  // no line with old parameters may follow the command
  }
  parameters_ = parameters;
  configured_at_ = now;
  motor_error_ = false;
  if (!config_.requests_survive_head_command) {
    owed_ = 0;
  }
  if (placed_) {
    take_up_position(now);
  }
}

void Scanner::set_gain(const GainBlock& values) {
  parameters_->ad_span = values.ad_span[0];
  parameters_->ad_low = values.ad_low[0];
  parameters_->gain[0] = values.gain[0];
  parameters_->slope[0] = values.slope[0];
}

void Scanner::reverse() {
  parameters_->control ^= control_bits::scan_right;
  sweep_.reverse();
}

void Scanner::request(TimePoint now) {
  const int lines = config_.half_duplex ? 1 : 2;
  const int added = std::min(lines, lines * config_.request_cap - owed_);
  if (owed_ == 0) {
    owed_since_ = now;
  }
  owed_ += added;
  counters_.requests_beyond_cap += static_cast<std::uint64_t>(lines - added);
}

// ---- Direction

/// When the centre is reached, starts the turn to the sector if there are parameters.
void Scanner::settle(TimePoint now) {
  if (placed_ || now < centred_at_) {
    return;
  }
  placed_ = true;
  if (parameters_) {
    take_up_position(centred_at_);
  }
}

void Scanner::take_up_position(TimePoint begin) {
  const int from = motor_.position(begin);
  sweep_.configure(*parameters_, from);
  const nanoseconds way = turning_time(*parameters_, std::abs(shortest_turn(from, sweep_.bearing())));
  const nanoseconds turn = std::min(way, config_.reposition_limit);
  motor_.turn_to(sweep_.bearing(), begin, begin + turn);
  // A client waits one second for its first line.
  const nanoseconds all = std::min(config_.reconfiguration_time + way, config_.reposition_limit);
  ready_at_ = std::max(begin + turn, configured_at_ + all);
}

// ---- Pings

void Scanner::feed(const std::optional<ReplayedPing>& ping) {
  cycle_.feed(ping && recorded_line(ping->wire) ? ping : std::nullopt);
}

std::optional<TimePoint> Scanner::next_start() const {
  if (!placed_ || !parameters_ || owed_ == 0) {
    return std::nullopt;
  }
  return cycle_.next_start(std::max({ready_at_, owed_since_, cycle_.answered_at()}), next_ping_at_);
}

/// Time from one ping of the sweep to the next.
nanoseconds Scanner::wanted_period() const {
  const LineTiming timing = line_timing(*parameters_, config_, parameters_->step);
  return std::max(config_.line_period.value_or(timing.period(config_)), timing.listen);
}

std::optional<TimePoint> Scanner::ping_due() const {
  return cycle_.granted() ? next_start() : std::nullopt;
}

std::optional<TimePoint> Scanner::line_due() const {
  return cycle_.rendered() ? std::optional{ping_.line_due} : std::nullopt;
}

/// When a rendered line may be sent.
TimePoint Scanner::line_due_of(TimePoint transmit_time, nanoseconds line_after) const {
  if (config_.simulated_time) {
    return transmit_time;
  }
  return config_.line_period ? transmit_time + std::min(line_after, *config_.line_period)
                             : std::max(transmit_time + line_after, link_free_at_);
}

void Scanner::begin_ping(TimePoint now, TimePoint due) {
  const TimePoint transmit_time = std::max(due, now - lateness_allowed);
  const auto& fed = cycle_.fed();
  cycle_.begin(fed ? repeat(transmit_time, *fed) : aim(transmit_time), transmit_time);
}

/// Makes a job at the bearing of the sweep with the parameters of the client.
PingJob Scanner::aim(TimePoint transmit_time) {
  PingJob job = make_line_job(*parameters_, config_, sweep_.bearing());
  job.period = wanted_period();
  const nanoseconds line_after = line_timing(*parameters_, config_, 0).listen + config_.line_overhead;
  ping_.line = make_line();
  ping_.line_due = line_due_of(transmit_time, line_after);
  return job;
}

/// Makes a job for a recorded line. Its line leaves when its echoes have arrived; its due time sets the pace.
PingJob Scanner::repeat(TimePoint transmit_time, const ReplayedPing& fed) {
  ping_.line = recorded_line(fed.wire).value();
  PingJob job = make_line_job(fed, ping_.line);
  job.differences = differences(*parameters_, job, ping_.line);
  motor_.place(ping_.line.bearing);
  const nanoseconds listening = job.listening_time;
  ping_.line_due = transmit_time + std::min(listening, config_.line_period.value_or(listening));
  return job;
}

void Scanner::on_image(TimePoint now, const PingImage& image) {
  if (!cycle_.on_image(now, image.number)) {
    return;
  }
  if (image.u8.size() != static_cast<std::size_t>(cycle_.job().bins())) {
    cycle_.fail();
    end_ping();
    return;
  }
  ping_.samples = image.u8;
  ping_.line_due = std::max(ping_.line_due, now);
}

void Scanner::on_image_failed(TimePoint now, std::uint64_t number) {
  if (cycle_.on_image_failed(now, number)) {
    end_ping();
  }
}

HeadData Scanner::make_line() const {
  const HeadCommand& parameters = *parameters_;
  HeadData line;
  line.sweep = sweep_.code();
  line.control = parameters.control;
  if (config_.always_reports_scan_right) {
    line.control |= control_bits::scan_right;
  }
  line.status = parameters.has(control_bits::eight_bit) ? head_status_bits::eight_bit : std::uint8_t{0};
  line.range_scale = parameters.range_scale;
  line.tx_word = parameters.tx_word[0];
  line.gain = parameters.gain[0];
  line.slope = parameters.slope[0];
  line.ad_span = parameters.ad_span;
  line.ad_low = parameters.ad_low;
  line.ad_interval = parameters.ad_interval;
  line.left_limit = parameters.left_limit;
  line.right_limit = parameters.right_limit;
  line.step = parameters.step;
  line.bearing = static_cast<std::uint16_t>(sweep_.bearing());
  return line;
}

/// The bins with the bit depth of the wire.
std::vector<std::uint8_t> Scanner::bins() const {
  if (ping_.line.eight_bit() || config_.plays_back) {
    return ping_.samples;
  }
  std::vector<std::uint8_t> values(ping_.samples.size());
  std::ranges::transform(ping_.samples, values.begin(), [&](std::uint8_t amplitude) {
    return to_four_bit(amplitude, ping_.line.ad_low, ping_.line.ad_span);
  });
  return values;
}

PingRecord Scanner::record_of(const HeadData& line) const {
  PingRecord record = line_record(cycle_.job());
  record.settings.frequency_hz = carrier_hz;
  record.bits_per_bin = line.eight_bit() ? 8 : 4;
  record.samples = bins();
  record.wire = recorded_wire(line, config_.node);
  return record;
}

void Scanner::send_line(std::vector<std::vector<std::uint8_t>>& out) {
  HeadData line = ping_.line;
  if (motor_error_) {
    line.status |= head_status_bits::motor_error;
  }
  PingRecord record = record_of(line);
  const auto packed = line.eight_bit() ? record.samples : pack_nibbles(record.samples, config_.nibble_order);
  line.data = packed;
  out.push_back(encode(line, config_.node));
  ++counters_.pings_sent;
  link_free_at_ = ping_.line_due + line_timing(*parameters_, config_, 0).send;
  cycle_.put_on_wire(std::move(record));
  end_ping();
}

/// Moves to the next bearing, after a sent or failed ping.
void Scanner::end_ping() {
  next_ping_at_ = config_.plays_back ? ping_.line_due : time_of_next_ping();
  --owed_;
}

/// Turns to the next bearing and returns the earliest time of a ping there.
TimePoint Scanner::time_of_next_ping() {
  const int way = sweep_.step();
  motor_.place(sweep_.bearing());
  const LineTiming timing = line_timing(*parameters_, config_, way);
  const TimePoint next = cycle_.job().transmit_time + config_.line_period.value_or(timing.period(config_));
  // In half duplex the next ping waits for a late line.
  return config_.half_duplex && !config_.line_period ? std::max(next, link_free_at_ + timing.turn) : next;
}

// ---- Time

void Scanner::advance(TimePoint now, std::vector<std::vector<std::uint8_t>>& out) {
  settle(now);
  if (const auto due = line_due(); due && now >= *due) {
    send_line(out);
  }
  if (const auto due = ping_due(); due && now >= *due) {
    begin_ping(now, *due);
  }
}

std::optional<TimePoint> Scanner::next_deadline() const {
  if (!placed_) {
    return centred_at_;
  }
  return cycle_.under_way() ? line_due() : ping_due();
}

void Scanner::report(Actions& actions) {
  cycle_.report(actions);
  if (const auto start = next_start()) {
    actions.next_ping = NextPing{*start, wanted_period(), line_timing(*parameters_, config_, 0).listen};
  }
}

}  // namespace sonard::micron
