#include "protocol/micron/scanner.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/line_job.hpp"

namespace sonard::micron {
namespace {

using std::chrono::nanoseconds;

/// A caller that is late by less keeps the pace; what it has missed beyond is not made up for.
constexpr std::chrono::milliseconds lateness_allowed{50};

}  // namespace

Scanner::Scanner(const DeviceConfig& config, DeviceCounters& counters)
    : config_(config), counters_(counters), motor_(config.power_up_bearing), sweep_(config.limits_order) {}

void Scanner::restart(TimePoint now, TimePoint begin) {
  cancel_ping();
  parameters_.reset();
  motor_error_ = false;
  owed_ = 0;
  placed_ = false;
  motor_.place(motor_.position(now));
  const double way_rad = std::abs(bearing_rad(motor_.position(now)));
  const nanoseconds seek{static_cast<nanoseconds::rep>(way_rad / config_.seek_speed_rad_s * 1e9)};
  motor_.turn_to(bearing_ahead, begin, begin + seek);
  centred_at_ = begin + std::max(config_.centring_time, seek);
}

// ---- Commands

void Scanner::configure(TimePoint now, const HeadCommand& parameters) {
  settle(now);
  cancel_ping();  // no line with old parameters may follow
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

// ---- Where it looks

/// The centre is reached: on to the sector, if there is one.
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
  // A client gives its first line one second.
  const nanoseconds all = std::min(config_.reconfiguration_time + way, config_.reposition_limit);
  ready_at_ = std::max(begin + turn, configured_at_ + all);
}

// ---- Pings

std::optional<TimePoint> Scanner::ping_possible() const {
  if (!placed_ || !parameters_ || owed_ == 0 || ping_ || unanswered_) {
    return std::nullopt;
  }
  const TimePoint possible = std::max({ready_at_, owed_since_, free_since_});
  // Where another time rules, whoever permits a ping has kept the pace in that one.
  return config_.waits_for_permission ? possible : std::max(possible, next_ping_at_);
}

std::optional<PingWish> Scanner::wish() const {
  const auto possible = ping_possible();
  if (!possible) {
    return std::nullopt;
  }
  const LineTiming timing = line_timing(*parameters_, config_, parameters_->step);
  return PingWish{*possible, std::max(config_.line_period.value_or(timing.period(config_)), timing.listen),
                  timing.listen};
}

std::optional<TimePoint> Scanner::ping_due() const {
  return config_.waits_for_permission && !permitted_ ? std::nullopt : ping_possible();
}

std::optional<TimePoint> Scanner::line_due() const {
  return ping_ && !ping_->samples.empty() ? std::optional{ping_->line_due} : std::nullopt;
}

TimePoint Scanner::line_due_of(TimePoint transmit_time, nanoseconds line_after) const {
  if (config_.waits_for_permission) {
    return transmit_time;
  }
  return config_.line_period ? transmit_time + std::min(line_after, *config_.line_period)
                             : std::max(transmit_time + line_after, link_free_at_);
}

void Scanner::start_ping(TimePoint now, TimePoint due) {
  permitted_ = false;
  const LineTiming timing = line_timing(*parameters_, config_, 0);
  Ping ping;
  ping.number = next_ping_number_++;
  ping.transmit_time = std::max(due, now - lateness_allowed);
  ping.line_due = line_due_of(ping.transmit_time, timing.listen + config_.line_overhead);
  job_ = make_line_job(*parameters_, config_, sweep_.bearing());
  job_->ping_number = ping.number;
  job_->transmit_time = ping.transmit_time;
  ping_ = std::move(ping);
  ++counters_.pings_started;
}

std::optional<MicronJob> Scanner::take_job() {
  auto job = std::exchange(job_, std::nullopt);
  if (job) {
    unanswered_ = job->ping_number;
  }
  return job;
}

/// True when it answers the ping that is acquired.
bool Scanner::answered(TimePoint now, std::uint64_t ping_number) {
  if (unanswered_ != ping_number) {
    ++counters_.stale_lines;
    return false;
  }
  unanswered_.reset();
  free_since_ = now;
  return ping_ && ping_->number == ping_number;
}

void Scanner::on_line(TimePoint now, const MicronLine& line) {
  if (!answered(now, line.ping_number)) {
    return;
  }
  if (line.samples.size() != static_cast<std::size_t>(effective_bins(*parameters_))) {
    ++counters_.pings_failed;
    end_ping();
    return;
  }
  ping_->samples = line.samples;
  ping_->line_due = std::max(ping_->line_due, now);
}

void Scanner::on_line_failed(TimePoint now, std::uint64_t ping_number) {
  if (answered(now, ping_number)) {
    ++counters_.pings_failed;
    end_ping();
  }
}

std::vector<std::uint8_t> Scanner::bins_of(const Ping& ping) const {
  const HeadCommand& parameters = *parameters_;
  if (parameters.has(control_bits::eight_bit)) {
    return ping.samples;
  }
  std::vector<std::uint8_t> values(ping.samples.size());
  std::ranges::transform(ping.samples, values.begin(), [&](std::uint8_t amplitude) {
    return to_four_bit(amplitude, parameters.ad_low, parameters.ad_span);
  });
  return values;
}

std::vector<std::uint8_t> Scanner::make_line(const Ping& ping) const {
  const HeadCommand& parameters = *parameters_;
  HeadData line;
  line.sweep = sweep_.code();
  line.control = parameters.control;
  if (config_.always_reports_scan_right) {
    line.control |= control_bits::scan_right;
  }
  line.status = motor_error_ ? head_status_bits::motor_error : std::uint8_t{0};
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
  if (parameters.has(control_bits::eight_bit)) {
    line.status |= head_status_bits::eight_bit;
    line.data = ping.samples;
    return encode(line, config_.node);
  }
  const auto packed = pack_nibbles(bins_of(ping), config_.nibble_order);
  line.data = packed;
  return encode(line, config_.node);
}

void Scanner::send_line(std::vector<std::vector<std::uint8_t>>& out) {
  out.push_back(make_line(*ping_));
  sent_ = SentLine{ping_->number, parameters_->has(control_bits::eight_bit), bins_of(*ping_)};
  ++counters_.lines_sent;
  link_free_at_ = ping_->line_due + line_timing(*parameters_, config_, 0).send;
  end_ping();
}

/// The line is sent, or will never be: on to the next bearing.
void Scanner::end_ping() {
  const int way = sweep_.step();
  motor_.place(sweep_.bearing());
  const LineTiming timing = line_timing(*parameters_, config_, way);
  next_ping_at_ = ping_->transmit_time + config_.line_period.value_or(timing.period(config_));
  if (config_.half_duplex && !config_.line_period) {
    next_ping_at_ = std::max(next_ping_at_, link_free_at_ + timing.turn);  // after a line that came late
  }
  --owed_;
  ping_.reset();
}

void Scanner::cancel_ping() {
  if (ping_) {
    ++counters_.pings_cancelled;
  }
  ping_.reset();
  job_.reset();
}

// ---- Time

void Scanner::advance(TimePoint now, std::vector<std::vector<std::uint8_t>>& out) {
  settle(now);
  if (const auto due = line_due(); due && now >= *due) {
    send_line(out);
  }
  if (const auto due = ping_due(); due && now >= *due) {
    start_ping(now, *due);
  }
}

std::optional<TimePoint> Scanner::next_deadline() const {
  if (!placed_) {
    return centred_at_;
  }
  return ping_ ? line_due() : ping_due();
}

}  // namespace sonard::micron
