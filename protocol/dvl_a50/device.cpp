// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/device.hpp"

#include <cmath>
#include <utility>
#include <variant>

#include "protocol/common/endpoint.hpp"
#include "protocol/dvl_a50/device_impl.hpp"
#include "protocol/dvl_a50/pathfinder.hpp"
#include "protocol/dvl_a50/sentences.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr std::size_t most_delayed = 32;

bool same_client(const Peer& a, const Peer& b) {
  return a.channel == b.channel && a.remote == b.remote;
}

}  // namespace

// ---- Clients

Device::Impl::Client& Device::Impl::client_of(const Peer& peer) {
  const auto known =
      std::ranges::find_if(clients_, [&](const Client& it) { return same_client(it.peer, peer); });
  if (known != clients_.end()) {
    return *known;
  }
  if (peer.channel != config_.http_channel) {
    notices_.push_back({Notice::Level::info, fmt::format("client {} connected", endpoint_text(peer.remote))});
  }
  clients_.push_back({peer, {}, {}});
  return clients_.back();
}

void Device::Impl::forget(const Peer& peer) {
  std::erase_if(delayed_, [&](const Delayed& it) { return same_client(it.peer, peer); });
  if (std::erase_if(clients_, [&](const Client& it) { return same_client(it.peer, peer); }) > 0 &&
      peer.channel != config_.http_channel) {
    notices_.push_back({Notice::Level::info, fmt::format("client {} is gone", endpoint_text(peer.remote))});
  }
}

/// True if anybody could read a report.
bool Device::Impl::heard() const {
  return config_.serial_channel >= 0 || std::ranges::any_of(clients_, [this](const Client& client) {
           return client.peer.channel != config_.http_channel;
         });
}

void Device::Impl::send_to_channel(int channel, const SharedBytes& bytes) {
  for (const Client& client : clients_) {
    if (client.peer.channel == channel) {
      send(client.peer, bytes);
    }
  }
}

void Device::Impl::answer(TimePoint now, const Peer& peer, std::string_view text, nanoseconds delay) {
  if (delay <= nanoseconds{0}) {
    send(peer, bytes_of(text));
  } else if (delayed_.size() < most_delayed) {
    delayed_.push_back({now + delay, peer, bytes_of(text)});
  }
}

// ---- Motion

void Device::Impl::take(TimePoint now, const SensorsRead& sensors) {
  readings_ = sensors.readings;
  move(now);
}

/// Goes on with dead reckoning: in simulated time up to the time of the readings, whatever the clock says.
void Device::Impl::move(TimePoint now) {
  if (readings_) {
    const nanoseconds moved_to =
        config_.simulated_time ? readings_->simulated_time.value_or(nanoseconds{0}) : now;
    const double turn_rad = settings_.mounting_rotation_offset_deg * std::numbers::pi / 180.0;
    dead_reckoning_.move(moved_to, vehicle_motion(device_motion(*readings_), turn_rad), locked_);
  }
}

void Device::Impl::report_position(TimePoint now) {
  if (now < position_due_) {
    return;
  }
  position_due_ = std::max(position_due_ + position_period, now + position_period / 2);
  move(now);
  Position position = dead_reckoning_.position();
  position.time_s = 1e-6 * static_cast<double>(clock_.unix_us(now));
  send_json(encode(position, format()));
  if (config_.serial_channel >= 0 && (serial_output_ == 1 || serial_output_ == 3)) {
    send_serial(position_sentence(position));
  }
}

// ---- Pings

std::optional<TimePoint> Device::Impl::next_start() const {
  return pinging() ? cycle_.next_start(std::max(wanted_, cycle_.answered_at()), next_ping_) : std::nullopt;
}

/// When the image is complete; nullopt if there is no image.
std::optional<TimePoint> Device::Impl::image_due() const {
  if (!cycle_.rendered()) {
    return std::nullopt;
  }
  return cycle_.job().transmit_time + (config_.simulated_time ? nanoseconds{0} : cycle_.job().listening_time);
}

void Device::Impl::begin_ping(TimePoint now) {
  const std::optional<TimePoint> start = next_start();
  if (!start || now < *start || !cycle_.granted()) {
    return;
  }
  ping_ = {
      .plan = plan(), .triggered = !settings_.acoustic_enabled, .recorded = {}, .report = {}, .samples = {}};
  const nanoseconds period = std::max(this->period(ping_.plan), listening_time(ping_.plan));
  if (locked_ && settings_.periodic_cycling_enabled && now >= next_cycling_ && !ping_.triggered) {
    // A look for a nearer bottom takes the place of a ping (5).
    next_cycling_ = std::max(next_cycling_, now - config_.cycling_interval) + config_.cycling_interval;
    next_ping_ = now + period;
    cycle_.skip();
    return;
  }
  PingJob job;
  if (const std::optional<ReplayedPing>& fed = cycle_.fed()) {
    ping_.recorded = recorded_form(fed->wire);
    job = make_job(*fed);
  } else {
    job = make_job(ping_.plan, config_);
  }
  job.period = std::max(period, job.listening_time);
  triggers_ -= ping_.triggered ? 1 : 0;
  last_start_ = now;
  // Keeps the phase; after a late call at most one missed period is caught up.
  next_ping_ = std::max(std::max(next_ping_, now - job.period) + job.period, now + job.listening_time);
  cycle_.begin(std::move(job), now);
}

void Device::Impl::take(TimePoint now, const PingRendered& ping) {
  if (!cycle_.on_image(now, ping.image.number)) {
    return;
  }
  if (ping_.recorded) {
    ping_.report = *ping_.recorded;
    ping_.samples = ping.image.u8;
    if (ping.image.u8.size() != static_cast<std::size_t>(cycle_.job().bins())) {
      cycle_.fail();
    }
    return;
  }
  const auto ranges_m = beam_ranges_m(ping.image.directions);
  if (!ranges_m) {
    cycle_.fail();
    return;
  }
  const SensorReadings readings = ping.image.readings.value_or(readings_.value_or(SensorReadings{}));
  Measurement found = measure(*ranges_m, device_motion(readings), ping_.plan, config_, settings_, noise_);
  ping_.report = found.report;
  mode_ = found.mode;
  locked_ = found.report.valid;
  const PingPlan next = plan();
  next_ping_ = std::min(next_ping_, last_start_ + std::max(period(next), cycle_.job().listening_time));
}

/// The report leaves after the processing delay, when the next ping may be under way.
void Device::Impl::finish_ping(TimePoint now) {
  const std::optional<TimePoint> due = image_due();
  if (!due || now < *due) {
    return;
  }
  const PingJob& job = cycle_.job();
  double sum_m = 0.0;
  int echoes = 0;
  for (const Beam& beam : ping_.report.beams) {
    sum_m += std::max(0.0, beam.distance_m);
    echoes += beam.distance_m > 0.0 ? 1 : 0;
  }
  const double way_m = echoes > 0 ? sum_m / echoes : job.range_m();
  const TimePoint reflected = job.transmit_time + travel_time(way_m, job.sound_speed_mps);
  ping_.report.validity_us = clock_.unix_us(reflected);
  const TimePoint leaves = config_.simulated_time ? now : std::max(now, reflected + config_.processing_delay);
  ping_.report.transmission_us = clock_.unix_us(leaves);
  PingRecord record = record_of(ping_.report, job.range_m(), job.sound_speed_mps);
  if (ping_.recorded) {
    record.settings.bins = job.bins();
    record.settings.bin_m = job.bin_m();
    record.samples = std::move(ping_.samples);
  }
  cycle_.put_on_wire(std::move(record));
  ++counters_.pings_sent;
  pending_.push_back({leaves, ping_.report});
}

void Device::Impl::report(TimePoint now, Velocity velocity) {
  counters_.without_bottom += velocity.valid ? 0 : 1;
  const nanoseconds since = reported_at_ ? now - *reported_at_ : cycle_.job().period;
  velocity.since_last_ms =
      1e-3 * static_cast<double>(std::chrono::floor<std::chrono::microseconds>(since).count());
  velocity.transmission_us = clock_.unix_us(now);
  reported_at_ = now;
  send_json(encode(velocity, format()));
  const double sound_speed_mps = settings_.speed_of_sound_mps;
  const SharedBytes pd6 = bytes_of(encode_pd6(velocity, sound_speed_mps, config_.release));
  const SharedBytes pd4(encode_pd4(velocity, sound_speed_mps));
  send_to_channel(config_.pd6_channel, pd6);
  send_to_channel(config_.pd4_channel, pd4);
  if (config_.serial_channel < 0) {
    return;
  }
  if (serial_output_ == 2 || serial_output_ == 6) {
    send(serial_peer(), serial_output_ == 2 ? pd6 : pd4);
  } else if (serial_output_ != 0) {
    send_serial(velocity_sentence(velocity));
    for (const Beam& beam : velocity.beams) {
      send_serial(beam_sentence(beam));
    }
    if (serial_output_ == 1) {
      send_serial(old_velocity_sentence(velocity));
      send_serial(old_distance_sentence(velocity));
    }
  }
}

// ---- Time

void Device::Impl::advance(TimePoint now) {
  if (line_until_ && now >= *line_until_) {
    line_until_.reset();
    take_line(now, std::exchange(line_, {}) + "?");
  }
  const auto waits = [now](const Delayed& it) { return now < it.due; };
  const auto due = std::stable_partition(delayed_.begin(), delayed_.end(), waits);
  for (auto it = due; it != delayed_.end(); ++it) {
    send(it->peer, it->bytes);
  }
  delayed_.erase(due, delayed_.end());

  finish_ping(now);
  while (!pending_.empty() && now >= pending_.front().due) {
    report(now, std::exchange(pending_.front().report, {}));
    pending_.pop_front();
  }
  report_position(now);
  if (!(heard() && (settings_.acoustic_enabled || ping_.triggered))) {
    cycle_.cancel();
  }
  if (pinging() && !std::exchange(was_pinging_, pinging())) {
    wanted_ = now;
  }
  was_pinging_ = pinging();
  begin_ping(now);
}

Actions Device::Impl::actions(TimePoint now) {
  Actions actions;
  actions.send = std::exchange(outgoing_, {});
  actions.disconnect = std::exchange(disconnect_, {});
  actions.notices = std::exchange(notices_, {});
  cycle_.report(actions);
  actions.nobody_there = !heard();
  TimePoint wake = position_due_;
  const auto also = [&](std::optional<TimePoint> due) { wake = due ? std::min(wake, *due) : wake; };
  also(line_until_);
  also(image_due());
  for (const Delayed& it : delayed_) {
    also(it.due);
  }
  if (!pending_.empty()) {
    also(pending_.front().due);
  }
  if (const std::optional<TimePoint> start = next_start()) {
    if (config_.simulated_time) {
      const PingPlan next = plan();
      const nanoseconds listening = listening_time(next);
      actions.next_ping = NextPing{*start, std::max(period(next), listening), listening};
    } else {
      also(*start);
    }
  }
  actions.wake_at = std::max(wake, now + nanoseconds{1});
  return actions;
}

std::vector<Counter> Device::Impl::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  const DeviceCounters& count = counters_;
  return {
      {"pings_sent", count.pings_sent, "pings measured and reported"},
      {"pings_failed", count.pings_failed, "pings that could not be rendered", Fault::none, Shown::often},
      {"pings_cancelled", count.pings_cancelled, "pings that a command or the end of all clients ended"},
      {"without_bottom", count.without_bottom, "reports without bottom lock", Fault::none, Shown::often},
      {"commands", count.commands, "commands that the device knows"},
      {"refused", count.refused, "commands answered as failed: an unknown one, a wrong value",
       Fault::of_client, Shown::often},
      {"unreadable", count.unreadable, "JSON objects without a command, serial lines that are no command",
       Fault::of_client, Shown::warns, "{} messages of clients were no commands"},
      {"dropped_bytes", count.dropped_bytes, "bytes between JSON objects, ignored", Fault::of_client,
       Shown::often},
      {"bad_checksums", count.bad_checksums, "serial commands with a wrong checksum", Fault::of_client,
       Shown::warns, "{} serial commands had a wrong checksum"},
      {"overflows", count.overflows, "clients disconnected: more than 64 kB without the end of an object",
       Fault::of_client, Shown::warns, "{} clients were disconnected: a JSON object had no end"},
      {"http_requests", count.http_requests, "requests to the web page"},
  };
}

// ---- Device

Device::Device(const DeviceConfig& config, TimePoint start) : impl_(std::make_unique<Impl>(config, start)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  return impl_->actions(now);
}

PingProgress Device::progress() const {
  const DeviceCounters& count = counters();
  return {.sent = count.pings_sent, .ended = count.pings_ended(), .messages = count.pings_sent};
}

std::vector<Counter> Device::counts() const {
  return impl_->counts();
}

const DeviceCounters& Device::counters() const {
  return impl_->counters();
}

}  // namespace sonard::dvl_a50
