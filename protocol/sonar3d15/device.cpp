// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/device.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "protocol/common/noise.hpp"
#include "protocol/common/once_warnings.hpp"
#include "protocol/sonar3d15/controls.hpp"
#include "protocol/sonar3d15/http.hpp"
#include "protocol/sonar3d15/imu.hpp"
#include "protocol/sonar3d15/shot.hpp"

namespace sonard::sonar3d15 {
namespace {

using std::chrono::nanoseconds;

constexpr int most_pixels = 20'000;
constexpr int most_imu_samples = 1000;

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument(std::string("sonar3d15 device: ") + what);
  }
}

void validate(const ModeConfig& mode) {
  const auto angle = [](double degrees) { return degrees > 0.0 && degrees <= 160.0; };
  require(mode.rate_hz >= 0.001 && mode.rate_hz <= 1000.0, "rate_hz must be 0.001..1000");
  require(mode.latency >= nanoseconds{0}, "latency must not be negative");
  require(angle(mode.horizontal_fov_deg) && angle(mode.vertical_fov_deg),
          "a field of view must be up to 160 degrees");
  require(mode.carrier_hz > 0.0, "carrier_hz must be positive");
}

const DeviceConfig& validated(const DeviceConfig& config) {
  const auto speed = [](double mps) { return mps >= 500.0 && mps <= 5000.0; };
  validate(config.low);
  validate(config.high);
  require(config.udp_mode != UdpMode::unicast || (config.unicast.address != 0 && config.unicast.port != 0),
          "unicast must have an address and a port");
  require(config.most_range_m > 0.0 && config.most_range_m <= 50.0, "most_range_m must be 0..50");
  require(config.least_range_m >= 0.0 && config.range_m > config.least_range_m &&
              config.range_m <= config.most_range_m,
          "least_range_m and range_m must rise within 0..most_range_m");
  require(config.columns >= 2 && config.rows >= 2 && config.columns <= most_pixels / config.rows,
          "columns and rows must be at least 2, and 20000 pixels at most");
  require(config.time_scale >= 0.0 && config.time_scale <= 1000.0, "time_scale must be 0..1000");
  require(config.pixel_scale_m > 0.0 && config.range_step_s > 0.0,
          "pixel_scale_m and range_step_s must be positive");
  require(config.gain > 0.0 && config.threshold >= 30.0, "gain must be positive, threshold at least 30");
  require(config.range_bin_m >= 0.001, "range_bin_m must be at least 0.001");
  require(config.speed_change_time >= nanoseconds{0}, "speed_change_time must not be negative");
  require(config.imu_force_noise_mps2 >= 0.0 && config.imu_rate_noise_radps >= 0.0,
          "imu noise must not be negative");
  require(config.imu_batch_samples >= 0 && config.imu_batch_samples <= most_imu_samples,
          "imu_batch_samples must be 0..1000");
  require(speed(config.water_sound_speed_mps) && speed(config.automatic_sound_speed_mps),
          "a speed of sound must be 500..5000");
  return config;
}

}  // namespace

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint boot_time)
      : config_(validated(config)),
        controls_(config_, boot_time),
        cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, boot_time,
               counters_),
        next_shot_(boot_time),
        sequence_(config.first_sequence),
        imu_noise_(config.seed) {}

  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& received);
  void take(TimePoint, const ClientCame& came) { clients_[came.who.remote] = {}; }
  void take(TimePoint, const ClientGone& gone) { clients_.erase(gone.who.remote); }
  void take(TimePoint now, const PingRendered& ping);
  void take(TimePoint now, const PingNotRendered& ping) { cycle_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the head has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead&) {}   // readings come with the image
  void take(TimePoint, const PingFed& feed) {
    cycle_.feed(feed.ping && recorded_form(feed.ping->wire) ? feed.ping : std::nullopt);
  }
  void take(TimePoint, const NextPingDue&) { cycle_.grant(); }

  void advance(TimePoint now);
  Actions actions(TimePoint now);
  PingProgress progress() const { return {counters_.pings_sent, counters_.pings_ended(), datagrams_}; }
  std::vector<Counter> counts() const;
  const PingCounters& counters() const { return counters_; }

 private:
  /// The shot under way.
  struct Ping {
    Shot shot;
    double least_range_m = 0.0;
    nanoseconds latency{};
    double carrier_hz = 0.0;
    std::optional<RecordedSettings> recorded;
    std::vector<std::uint8_t> samples;  ///< of a recorded shot, set at the arrival of the image
  };

  Reply answer(TimePoint now, const Peer& client, const Request& request);
  void answer_broken(const Peer& client, int status);
  PingJob job(TimePoint now) const {
    return make_job(config_, controls_.settings(), controls_.sound_speed_mps(now));
  }
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> send_due() const;
  void begin_shot(TimePoint now);
  void send_shot(TimePoint now);
  std::vector<std::uint8_t> send_image(const google::protobuf::Message& image);
  void send_imu_batches();

  const DeviceConfig config_;
  Controls controls_;
  std::map<Endpoint, RequestBuffer> clients_;
  PingCounters counters_;
  PingCycle cycle_;
  Ping ping_;
  TimePoint next_shot_;
  std::uint32_t sequence_;
  std::uint32_t imu_sequence_ = 0;
  Noise imu_noise_;
  ImuBatch imu_waiting_;                       ///< samples of no batch yet
  SensorReadings readings_, readings_before_;  ///< at the last two shots
  TimePoint read_at_{}, read_before_{};        ///< their times; equal if there is one
  OnceWarnings warnings_;
  Actions actions_;

  std::uint64_t datagrams_ = 0;
  std::uint64_t requests_ = 0;
  std::uint64_t refused_ = 0;
  std::uint64_t unknown_paths_ = 0;
  std::uint64_t broken_requests_ = 0;
};

// ---- Clients

void Device::Impl::take(TimePoint now, const BytesReceived& received) {
  const auto client = clients_.find(received.from.remote);
  if (client == clients_.end()) {
    return;
  }
  client->second.append({received.bytes.data(), received.bytes.size()});
  while (const auto request = client->second.next()) {
    const bool stays = request->has_value() && (*request)->stays;
    const Reply reply =
        request->has_value() ? answer(now, received.from, **request) : Reply{request->error(), {}};
    actions_.send.push_back({Outgoing::To::peer, received.from, SharedBytes(encode(reply, stays))});
    if (!stays) {
      broken_requests_ += request->has_value() ? 0 : 1;
      actions_.disconnect.push_back(received.from);
      clients_.erase(client);
      return;
    }
  }
}

Reply Device::Impl::answer(TimePoint now, const Peer& client, const Request& request) {
  const bool acoustics = controls_.settings().acoustics;
  const Reply reply = controls_.answer(now, request);
  if (reply.status < 300) {
    ++requests_;
  } else if (reply.status == 404 || reply.status == 405) {
    ++unknown_paths_;
  } else {
    ++refused_;
    // Only paths of the head refuse values, so the path is not any text of a client.
    warnings_.warn("refused",
                   fmt::format("a client's {} {} was refused with status {}: {}", request.method,
                               request.path, reply.status, reply.body),
                   actions_.notices);
  }
  if (acoustics != controls_.settings().acoustics) {
    actions_.notices.push_back(
        {Notice::Level::info, fmt::format("client {} switched acoustics {}", endpoint_text(client.remote),
                                          acoustics ? "off" : "on")});
    next_shot_ = std::max(next_shot_, now);
  }
  return reply;
}

// ---- Shots

/// Start of the next shot; nullopt if no shot can begin.
std::optional<TimePoint> Device::Impl::next_start() const {
  return controls_.settings().acoustics ? cycle_.next_start(cycle_.answered_at(), next_shot_) : std::nullopt;
}

/// When the images can be sent; nullopt if they are not rendered.
std::optional<TimePoint> Device::Impl::send_due() const {
  if (!cycle_.rendered()) {
    return std::nullopt;
  }
  return cycle_.job().transmit_time + (config_.simulated_time ? nanoseconds{0} : ping_.latency);
}

void Device::Impl::begin_shot(TimePoint now) {
  const std::optional<TimePoint> start = next_start();
  if (!start || now < *start || !cycle_.granted()) {
    return;
  }
  const Settings& settings = controls_.settings();
  const ModeConfig& mode = config_.mode(settings.high_frequency);
  ping_ = {make_shot(config_, settings, controls_.sound_speed_mps(now)),
           settings.least_range_m,
           mode.latency,
           mode.carrier_hz,
           {},
           {}};
  PingJob job = this->job(now);
  if (const std::optional<ReplayedPing>& fed = cycle_.fed()) {
    const Shot recorded = *recorded_form(fed->wire);
    job.differences = differences(ping_.shot, recorded);
    job.native_bins = fed->settings.bins;
    job.native_bin_m = fed->settings.bin_m;
    job.directions = {};
    ping_.shot = recorded;
    ping_.recorded = fed->settings;
  }
  // Keeps the phase; after a late call at most one missed period is caught up.
  next_shot_ = std::max(std::max(next_shot_, now - job.period) + job.period, now + job.listening_time);
  cycle_.begin(std::move(job), now);
}

void Device::Impl::take(TimePoint now, const PingRendered& ping) {
  const PingImage& image = ping.image;
  if (!cycle_.on_image(now, image.number)) {
    return;
  }
  if (ping_.recorded) {
    const auto samples =
        static_cast<std::size_t>(ping_.recorded->bins) * static_cast<std::size_t>(ping_.recorded->beams);
    ping_.samples = image.u8;
    if (image.u8.size() != samples) {
      cycle_.fail();
    }
  } else if (!add_echoes(image.directions, config_, ping_.least_range_m, ping_.shot)) {
    cycle_.fail();
  }
  const bool first = read_at_ == TimePoint{};
  readings_before_ = std::exchange(readings_, image.readings.value_or(readings_));
  read_before_ = std::exchange(read_at_, cycle_.job().transmit_time);
  if (first) {
    readings_before_ = readings_;
    read_before_ = read_at_;
  }
}

void Device::Impl::send_shot(TimePoint now) {
  const std::optional<TimePoint> due = send_due();
  if (!due || now < *due) {
    return;
  }
  set_header(controls_.utc(cycle_.job().transmit_time), sequence_++, ping_.shot);
  std::vector<std::uint8_t> wire = send_image(ping_.shot.range);
  const std::vector<std::uint8_t> signal = send_image(ping_.shot.signal);
  wire.insert(wire.end(), signal.begin(), signal.end());
  PingRecord record = record_of(ping_.shot, ping_.carrier_hz, std::move(wire));
  if (ping_.recorded) {
    record.settings = *ping_.recorded;
    record.samples = std::move(ping_.samples);
  }
  cycle_.put_on_wire(std::move(record));
  if (config_.sends_shaded) {
    send_image(shaded(ping_.shot));
  }
  ++counters_.pings_sent;
  if (controls_.settings().imu_batches) {
    send_imu_batches();
  } else {
    imu_waiting_.Clear();
  }
}

/// @return the packet, also if it is not sent
std::vector<std::uint8_t> Device::Impl::send_image(const google::protobuf::Message& image) {
  const bool compresses = config_.release >= Release{1, 6, 0};
  std::vector<std::uint8_t> packet =
      encode(image, config_.packets.value_or(compresses ? PacketId::rip2 : PacketId::rip1));
  if (const auto destination = controls_.destination()) {
    actions_.send.push_back({Outgoing::To::peer, Peer{image_channel, *destination, 0}, SharedBytes(packet)});
    ++datagrams_;
  }
  return packet;
}

void Device::Impl::send_imu_batches() {
  const auto samples = static_cast<int>(
      std::clamp<std::int64_t>(cycle_.job().period / nanoseconds{imu_period}, 1, most_imu_samples));
  ImuBatch batch = make_imu_batch(0, samples, controls_.utc(read_at_), readings_before_, readings_,
                                  read_at_ - read_before_);
  add_noise(config_, imu_noise_, batch);
  imu_waiting_.MergeFrom(batch);
  const int size = config_.imu_batch_samples > 0 ? config_.imu_batch_samples : imu_waiting_.timestamps_size();
  while (imu_waiting_.timestamps_size() >= size) {
    send_image(take_batch(imu_sequence_++, size, imu_waiting_));
  }
}

// ---- Time

void Device::Impl::advance(TimePoint now) {
  if (!controls_.settings().acoustics) {
    cycle_.cancel();
  }
  send_shot(now);
  begin_shot(now);
}

Actions Device::Impl::actions(TimePoint now) {
  Actions actions = std::exchange(actions_, {});
  cycle_.report(actions);
  actions.nobody_there = !controls_.settings().acoustics;
  actions.wake_at = send_due();
  if (const std::optional<TimePoint> start = next_start()) {
    if (config_.simulated_time) {
      const PingJob next = job(now);
      actions.next_ping = NextPing{*start, next.period, next.listening_time};
    } else {
      actions.wake_at = start;  // no shot can begin while one is under way
    }
  }
  return actions;
}

std::vector<Counter> Device::Impl::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  return {
      {"pings_sent", counters_.pings_sent, "shots sent, or made while UDP was disabled"},
      {"pings_failed", counters_.pings_failed, "shots that could not be rendered", Fault::none, Shown::often},
      {"pings_cancelled", counters_.pings_cancelled, "shots that a client ended by switching acoustics off"},
      {"datagrams", datagrams_, "images and IMU batches sent"},
      {"requests", requests_, "requests answered by status 200 or 204"},
      {"refused", refused_, "requests with a wrong value (400) or not possible now (409), without effect (5)",
       Fault::of_client, Shown::once},
      {"unknown_paths", unknown_paths_,
       "requests for a path or method that the release does not have (404, 405)", Fault::of_client,
       Shown::warns, "{} requests were for paths that this release does not have"},
      {"broken_requests", broken_requests_,
       "bytes that are not a request (400), and requests without a length or too long (411, 413, 431, 501); "
       "the client "
       "is disconnected",
       Fault::of_client, Shown::warns, "{} clients sent requests that cannot be read"},
  };
}

// ---- Device

Device::Device(const DeviceConfig& config, TimePoint boot_time)
    : impl_(std::make_unique<Impl>(config, boot_time)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  return impl_->actions(now);
}

PingProgress Device::progress() const {
  return impl_->progress();
}
std::vector<Counter> Device::counts() const {
  return impl_->counts();
}
const PingCounters& Device::counters() const {
  return impl_->counters();
}

}  // namespace sonard::sonar3d15
