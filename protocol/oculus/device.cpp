// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/device.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "protocol/common/ping_cycle.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/fire_warnings.hpp"
#include "protocol/oculus/frame.hpp"
#include "protocol/oculus/recorded_form.hpp"

namespace sonard::oculus {
namespace {

using std::chrono::nanoseconds;

std::array<std::uint8_t, 4> octets(Ipv4 address) {
  return {static_cast<std::uint8_t>(address >> 24), static_cast<std::uint8_t>(address >> 16),
          static_cast<std::uint8_t>(address >> 8), static_cast<std::uint8_t>(address)};
}

const DeviceConfig& validated(const DeviceConfig& config) {
  const auto require = [](bool condition, const char* what) {
    if (!condition) {
      throw std::invalid_argument(std::string("oculus device: ") + what);
    }
  };
  require(config.id != 0, "id must not be 0");
  require(config.status_period > nanoseconds{0}, "status_period must be positive");
  require(config.dummy_period > nanoseconds{0}, "dummy_period must be positive");
  require(config.plan.most_ranges >= 1 && config.plan.most_ranges <= 0xFFFF, "most_ranges must be 1..65535");
  require(config.plan.ping_overhead > nanoseconds{0}, "ping_overhead must be positive");
  return config;
}

}  // namespace

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint boot_time)
      : config_(validated(config)),
        identity_{config.id, config.plan.model.part_number},
        boot_time_(boot_time),
        next_status_(boot_time),
        address_(octets(config.address)),
        netmask_(octets(config.netmask)),
        user_config_{address_, netmask_, 0},
        warnings_(config_.plan.model),
        cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, boot_time,
               counters_) {}

  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& received);
  void take(TimePoint now, const ClientCame& came);
  void take(TimePoint now, const ClientGone& gone);
  void take(TimePoint now, const PingRendered& ping);
  void take(TimePoint now, const PingNotRendered& ping) { cycle_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the model has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead& sensors) { depth_m_ = sensors.readings.depth_m; }
  void take(TimePoint, const PingFed& feed) {
    cycle_.feed(feed.ping && recorded_form(feed.ping->wire) ? feed.ping : std::nullopt);
  }
  void take(TimePoint, const NextPingDue&) { cycle_.grant(); }

  void advance(TimePoint now);
  Actions actions();
  void move_to(Ipv4 address, Ipv4 netmask);
  PingProgress progress() const {
    return {counters_.pings_sent, counters_.pings_ended(), counters_.pings_sent};
  }
  std::vector<Counter> counts() const;
  const PingCounters& counters() const { return counters_; }

 private:
  /// The ping under way.
  struct Ping {
    PingPlan plan;
    double gain_percent = 0.0;        ///< for logs
    double amplitude_exponent = 1.0;  ///< for logs
    std::vector<std::uint8_t> image;  ///< set at the arrival of the image
  };

  bool pinging() const { return plan_.has_value(); }
  bool is_client(const Peer& peer) const { return client_ && client_->remote == peer.remote; }
  void send(std::vector<std::uint8_t> bytes) {
    actions_.send.push_back({Outgoing::To::peer, *client_, SharedBytes(std::move(bytes))});
  }
  bool client_is_idle(TimePoint now) const;
  void forget_client();
  void read_commands(TimePoint now);
  void handle(TimePoint now, const SimpleFire& fire);
  void handle(TimePoint now, const UserConfig& config);
  void handle(TimePoint, const Unknown& message) { unknown_id_ += message.id == MessageId::dummy ? 0 : 1; }

  void send_status(TimePoint now);
  void send_dummy(TimePoint now);
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> send_due() const;
  void begin_ping(TimePoint now);
  void send_ping(TimePoint now);

  const DeviceConfig config_;
  const Identity identity_;
  const TimePoint boot_time_;
  TimePoint next_status_;
  TimePoint next_dummy_{};
  TimePoint next_ping_{};
  std::array<std::uint8_t, 4> address_, netmask_;  ///< as reported in the status
  UserConfig user_config_;
  std::optional<double> depth_m_;  ///< for the status; nullopt: not known

  std::optional<Peer> client_;
  TimePoint newest_command_{};  ///< time of the client's last command, or of its connection
  CommandBuffer input_;
  FireWarnings warnings_;
  std::optional<PingPlan> plan_;  ///< of the newest fire; nullopt: no fire, or standby
  PingCounters counters_;
  PingCycle cycle_;
  Ping ping_;
  std::uint32_t ping_id_ = 0;
  Actions actions_;

  std::uint64_t commands_ = 0;
  std::uint64_t bad_commands_ = 0;
  std::uint64_t unknown_id_ = 0;
  std::uint64_t out_of_range_ = 0;
  std::uint64_t full_results_requested_ = 0;
  std::uint64_t other_clients_ = 0;
};

// ---- The client

/// A client with pings may stay silent for any time. A client without pings that is silent for long blocks
/// others without need.
bool Device::Impl::client_is_idle(TimePoint now) const {
  return !pinging() && now - newest_command_ >= most_silence;
}

void Device::Impl::take(TimePoint now, const ClientCame& came) {
  if (client_) {
    ++other_clients_;
    if (!client_is_idle(now)) {
      actions_.disconnect.push_back(came.who);
      return;
    }
    actions_.notices.push_back(
        {Notice::Level::info, "client " + endpoint_text(client_->remote) +
                                  " is disconnected: it was idle, and another client connected"});
    actions_.disconnect.push_back(*client_);
    forget_client();
  }
  client_ = came.who;
  newest_command_ = now;
  next_dummy_ = now + config_.dummy_period;
  next_status_ = now;
  actions_.notices.push_back(
      {Notice::Level::info, "client " + endpoint_text(came.who.remote) + " connected"});
  send(encode_log(config_.log_text, identity_));
}

void Device::Impl::take(TimePoint now, const ClientGone& gone) {
  if (!is_client(gone.who)) {
    return;
  }
  actions_.notices.push_back(
      {Notice::Level::info, "client " + endpoint_text(client_->remote) + " disconnected"});
  forget_client();
  next_status_ = now;
}

void Device::Impl::forget_client() {
  client_.reset();
  plan_.reset();
  input_.clear();
  cycle_.cancel();
}

void Device::Impl::take(TimePoint now, const BytesReceived& received) {
  if (is_client(received.from)) {
    input_.append({received.bytes.data(), received.bytes.size()});
    read_commands(now);
  }
}

void Device::Impl::read_commands(TimePoint now) {
  while (const auto message = input_.front()) {
    const auto command = decode_command(*message);
    if (command) {
      ++commands_;
      newest_command_ = now;
      std::visit([&](const auto& it) { handle(now, it); }, *command);
    } else {
      ++bad_commands_;
    }
    input_.pop();
  }
  if (input_.broken()) {
    ++bad_commands_;
    actions_.disconnect.push_back(*client_);
  }
}

void Device::Impl::handle(TimePoint now, const SimpleFire& fire) {
  if (!config_.plays_back) {
    out_of_range_ += warnings_.check(fire.fire, actions_.notices) ? 1 : 0;
    full_results_requested_ += requests_full_result(fire.fire) ? 1 : 0;
  }
  const bool before = pinging();
  plan_ = period_of_rate(fire.fire.ping_rate) ? std::optional(plan_ping(fire, config_.plan)) : std::nullopt;
  if (before && !pinging()) {
    cycle_.cancel();
    next_dummy_ = now;
  } else if (!before) {
    next_ping_ = std::max(next_ping_, now);
  }
}

void Device::Impl::handle(TimePoint, const UserConfig& config) {
  if (config.address != UserConfig{}.address) {
    user_config_ = config;  // stored only; the network of this machine is not changed
  }
  send(encode(user_config_, identity_));
}

// A configuration that a client has programmed stays stored, because it was never applied.
void Device::Impl::move_to(Ipv4 address, Ipv4 netmask) {
  const bool programmed = user_config_.address != address_;
  address_ = octets(address);
  netmask_ = octets(netmask);
  if (!programmed) {
    user_config_.address = address_;
    user_config_.netmask = netmask_;
  }
}

// ---- Pings

void Device::Impl::take(TimePoint now, const PingRendered& ping) {
  if (!cycle_.on_image(now, ping.image.number)) {
    return;
  }
  auto image = image_bytes(ping_.plan.result, ping.image.u8, ping.image.u16);
  if (!image) {
    cycle_.fail();
    return;
  }
  ping_.image = std::move(*image);
  if (ping.image.readings && !config_.plays_back) {
    report_readings(*ping.image.readings, config_.plan, ping_.plan.result);
  }
}

/// Start of the next ping; nullopt if no ping can begin.
std::optional<TimePoint> Device::Impl::next_start() const {
  return pinging() ? cycle_.next_start(boot_time_, next_ping_) : std::nullopt;
}

/// When the image can be sent; nullopt if there is no image.
std::optional<TimePoint> Device::Impl::send_due() const {
  return cycle_.rendered() ? std::optional(cycle_.job().transmit_time + ping_.plan.listening) : std::nullopt;
}

void Device::Impl::begin_ping(TimePoint now) {
  const std::optional<TimePoint> start = next_start();
  if (!start || now < *start || !cycle_.granted()) {
    return;
  }
  const std::optional<ReplayedPing>& fed = cycle_.fed();
  ping_ = Ping{fed ? held_to(*fed, *plan_) : *plan_,
               plan_->asked.fire.gain_percent,
               gamma_exponent(plan_->asked.fire.gamma),
               {}};
  const PingPlan& plan = ping_.plan;
  // Keeps the phase; after a late call at most one missed period is caught up.
  next_ping_ = std::max(std::max(next_ping_, now - plan.period) + plan.period, now + plan.listening);
  PingJob job = job_of(plan, config_.plan);
  if (fed) {
    job.differences = differences(*plan_, plan, fed->settings);
    ping_.amplitude_exponent = fed->settings.amplitude_exponent;
    if (fed->settings.gain_percent >= 0.0) {
      ping_.gain_percent = fed->settings.gain_percent;
    }
  }
  cycle_.begin(std::move(job), now);
}

void Device::Impl::send_ping(TimePoint now) {
  const std::optional<TimePoint> due = send_due();
  if (!due || now < *due) {
    return;
  }
  PingResult& result = ping_.plan.result;
  const nanoseconds start = cycle_.job().transmit_time - boot_time_;
  result.ping_id = ++ping_id_;
  result.start_time_ns = static_cast<std::uint32_t>(start.count());  // modulo 2^32
  result.start_time_s = static_cast<double>(start.count()) * 1e-9;
  result.image = ping_.image;
  std::vector<std::uint8_t> message = encode(result, identity_);
  PingRecord record = record_of(result, message);
  record.settings.gain_percent = ping_.gain_percent;
  record.settings.amplitude_exponent = ping_.amplitude_exponent;
  cycle_.put_on_wire(std::move(record));
  send(std::move(message));
  ++counters_.pings_sent;
}

// ---- Time

void Device::Impl::send_status(TimePoint now) {
  if (now < next_status_) {
    return;
  }
  Status status;
  status.device_id = config_.id;
  status.part_number = identity_.part_number;
  status.firmware = {0x01030007, 0x0134B35D, 0x01030007, 0x0134B35D, 0x00020001, 0x0134B35D};
  status.address = address_;
  status.netmask = netmask_;
  status.client = octets(client_ ? client_->remote.address : 0);
  status.mac = config_.mac;
  status.temperatures_c.fill(config_.plan.temperature_c);
  status.pressure_bar = pressure_bar(depth_m_, config_.plan);
  actions_.send.push_back(
      {Outgoing::To::everybody, Peer{status_channel, {}, 0}, SharedBytes(encode(status, identity_))});
  next_status_ += config_.status_period * ((now - next_status_) / config_.status_period + 1);
}

void Device::Impl::send_dummy(TimePoint now) {
  if (client_ && !pinging() && now >= next_dummy_) {
    send(encode_dummy(identity_));
    next_dummy_ += config_.dummy_period * ((now - next_dummy_) / config_.dummy_period + 1);
  }
}

void Device::Impl::advance(TimePoint now) {
  send_status(now);
  send_dummy(now);
  send_ping(now);
  begin_ping(now);
}

Actions Device::Impl::actions() {
  Actions actions = std::exchange(actions_, {});
  cycle_.report(actions);
  actions.nobody_there = !client_;
  TimePoint wake = next_status_;
  if (client_ && !pinging()) {
    wake = std::min(wake, next_dummy_);
  }
  wake = std::min(wake, send_due().value_or(wake));
  if (const std::optional<TimePoint> start = next_start()) {
    if (config_.simulated_time) {
      actions.next_ping = NextPing{*start, plan_->period, plan_->listening};
    } else {
      wake = std::min(wake, *start);
    }
  }
  actions.wake_at = wake;
  return actions;
}

std::vector<Counter> Device::Impl::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  return {
      {"pings_sent", counters_.pings_sent, "pings sent"},
      {"pings_failed", counters_.pings_failed, "pings that could not be rendered", Fault::none, Shown::often},
      {"pings_cancelled", counters_.pings_cancelled, "pings that standby or the end of a client ended"},
      {"commands", commands_, "commands that the head accepted"},
      {"bad_commands", bad_commands_,
       "messages shorter than a fire or user configuration, ignored; or above 4096 bytes, disconnected (3.1)",
       Fault::of_client, Shown::warns, "{} commands were too short or too long"},
      {"dropped_bytes", input_.dropped(), "bytes outside messages, skipped (3.1)", Fault::of_client,
       Shown::warns, "{} bytes from clients belonged to no message"},
      {"unknown_id", unknown_id_, "messages with an unknown msgId, ignored (2)", Fault::of_client,
       Shown::warns, "{} messages had an unknown ID: the head ignores them"},
      {"out_of_range", out_of_range_,
       "fires with a range, gain, sound speed, mode or rate out of limits, changed (3.3, 8)",
       Fault::of_client, Shown::once},
      {"full_results_requested", full_results_requested_,
       "fires that request the full result 0x22, which sonard does not have: it sends 0x23 (5)", Fault::none,
       Shown::once},
      {"other_clients", other_clients_, "connections while another client was connected, closed (7)",
       Fault::of_client, Shown::warns, "{} times a second client connected"}};
}

// ---- Device

Device::Device(const DeviceConfig& config, TimePoint boot_time)
    : impl_(std::make_unique<Impl>(config, boot_time)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  return impl_->actions();
}

PingProgress Device::progress() const {
  return impl_->progress();
}

void Device::move_to(Ipv4 address, Ipv4 netmask) {
  impl_->move_to(address, netmask);
}
std::vector<Counter> Device::counts() const {
  return impl_->counts();
}
const PingCounters& Device::counters() const {
  return impl_->counters();
}

}  // namespace sonard::oculus
