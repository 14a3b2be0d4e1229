// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/device.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/layout.hpp"
#include "protocol/ping1d/pinger.hpp"
#include "protocol/ping1d/scan.hpp"

namespace sonard::ping1d {
namespace {

using std::chrono::nanoseconds;

/// A request for data before the first ping waits for it, for no longer than clients expect an answer (3.1).
constexpr std::chrono::milliseconds longest_wait{40};
constexpr std::size_t most_waiting = 32;
constexpr std::uint32_t least_speed_mmps = 1'000'000, most_speed_mmps = 2'000'000;

bool is_measurement(std::uint16_t id) {
  const auto message = static_cast<MessageId>(id);
  return message == MessageId::distance_simple || message == MessageId::distance ||
         message == MessageId::profile;
}

const DeviceConfig& validated(const DeviceConfig& config) {
  const auto require = [](bool condition, const char* what) {
    if (!condition) {
      throw std::invalid_argument(std::string("ping1d device: ") + what);
    }
  };
  const auto within = [](auto value, auto least, auto most) { return value >= least && value <= most; };
  require(config.id != broadcast_id, "id must be 0..254");
  require(config.information.device_revision > 0, "information.device_revision must not be 0");
  require(config.water_sound_speed_mps > 0.0, "water_sound_speed_mps must be positive");
  require(config.least_range_m >= 0.0, "least_range_m must not be negative");
  require(within(config.points, 10, 1000), "points must be 10..1000");
  require(config.pulse_us_per_m > 0.0, "pulse_us_per_m must be positive");
  require(within(config.scan_length_mm, least_length_mm, most_range_mm), "scan_length_mm is out of range");
  require(config.gain_setting <= most_gain, "gain_setting must be 0..6");
  require(!config.auto_lengths_m.empty() &&
              std::ranges::adjacent_find(config.auto_lengths_m, std::ranges::greater_equal{}) ==
                  config.auto_lengths_m.end() &&
              config.auto_lengths_m.front() >= 1.0 && config.auto_lengths_m.back() <= 100.0,
          "auto_lengths_m must rise within 1..100");
  require(within(config.auto_target, 0.5, 0.8), "auto_target must be 0.5..0.8");
  require(within(config.confidence_window, 1, 100), "confidence_window must be 1..100");
  require(config.ping_overhead >= nanoseconds{0}, "ping_overhead must not be negative");
  require(within(config.time_scale, 0.0, 1000.0), "time_scale must be 0..1000");
  require(config.bootloader_silence >= nanoseconds{0}, "bootloader_silence must not be negative");
  const auto invalid = invalid_field(config);
  require(!invalid, invalid.value_or("").c_str());
  return config;
}

}  // namespace

class Device::Impl final : public Head {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : Head(config_, config.id, config.accepts_any_destination, counters_),
        config_(validated(config)),
        pinger_(config_, start, counters_) {}

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece) { receive(now, piece); }
  void take(TimePoint, const ClientCame&) {}
  void take(TimePoint now, const ClientGone& gone) { Head::take(now, gone); }
  void take(TimePoint now, const PingRendered& ping) { pinger_.on_image(now, ping.image); }
  void take(TimePoint now, const PingNotRendered& ping) { pinger_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the head has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead&) {}   // the head has no such sensors
  void take(TimePoint, const PingFed& feed) { pinger_.feed(feed.ping); }
  void take(TimePoint, const NextPingDue&) { pinger_.grant(); }

  void advance(TimePoint now);
  Actions actions(TimePoint now);

  const DeviceCounters& counters() const { return counters_; }
  std::vector<Counter> counts() const;

 private:
  /// A client's messages after every ping.
  struct Stream {
    Peer peer;
    std::uint16_t id = 0;
  };
  struct Waiting {
    Peer peer;
    std::uint16_t id = 0;
    TimePoint due{};
  };

  // The clients' side.
  bool keeps(const Peer& peer) const override;
  void on_bytes(TimePoint now) override;
  bool obey(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame) override {
    return Head::obey(now, asker, decode_command(frame),
                      [&](const auto& message) { handle(now, asker, message); });
  }
  void on_forget(TimePoint now, const Peer& peer, std::string_view why) override;

  // Answers.
  void reply(const Peer& asker, const Report& report) { send(asker, encode(report, id_)); }
  void accept(const Peer& asker, const Command& command);
  template <class Command, class Setting>
  bool set(const Peer& asker, const Command& command, std::uint32_t least, std::uint32_t most,
           Setting& setting);
  bool refused_in_auto(const Peer& asker, const Command& command);
  Report data(std::uint16_t id) const;
  void answer_waiting(TimePoint now);

  // One overload for each command.
  void handle(TimePoint now, const Peer& asker, const GeneralRequest& command);
  void handle(TimePoint now, const Peer& asker, const SetCommonDeviceId& command);
  void handle(TimePoint now, const Peer& asker, const SetDeviceId& command);
  void handle(TimePoint now, const Peer& asker, const SetRange& command);
  void handle(TimePoint now, const Peer& asker, const SetSpeedOfSound& command);
  void handle(TimePoint now, const Peer& asker, const SetModeAuto& command);
  void handle(TimePoint now, const Peer& asker, const SetPingInterval& command);
  void handle(TimePoint now, const Peer& asker, const SetGainSetting& command);
  void handle(TimePoint now, const Peer& asker, const SetPingEnable& command);
  void handle(TimePoint now, const Peer& asker, const GotoBootloader& command);
  void handle(TimePoint now, const Peer& asker, const ContinuousStart& command);
  void handle(TimePoint now, const Peer& asker, const ContinuousStop& command);
  void handle(TimePoint now, const Peer& asker, const Unknown& command);

  bool pinging(TimePoint now) const;

  const DeviceConfig config_;
  DeviceCounters counters_;
  Pinger pinger_;
  std::vector<Stream> streams_;
  std::vector<Waiting> waiting_;
  std::optional<TimePoint> heard_;  ///< newest bytes of any client
};

// ---- Clients

bool Device::Impl::keeps(const Peer& peer) const {
  return std::ranges::any_of(streams_, [&](const Stream& it) { return same_client(it.peer, peer); });
}

void Device::Impl::on_bytes(TimePoint now) {
  if (!pinging(now)) {
    pinger_.want(now);
  }
  heard_ = now;
}

void Device::Impl::on_forget(TimePoint, const Peer& peer, std::string_view) {
  const auto of_client = [&](const auto& it) { return same_client(it.peer, peer); };
  std::erase_if(streams_, of_client);
  std::erase_if(waiting_, of_client);
}

// ---- Requests

Report Device::Impl::data(std::uint16_t id) const {
  const Pinger::Settings& now = pinger_.settings;
  const DeviceInformation& information = config_.information;
  switch (static_cast<MessageId>(id)) {
    case MessageId::firmware_version:
      return FirmwareVersion{.major = information.firmware_major, .minor = information.firmware_minor};
    case MessageId::device_id:
      return DeviceId{id_};
    case MessageId::voltage_5:
      return Voltage5{config_.voltage_mv};
    case MessageId::speed_of_sound:
      return SpeedOfSound{now.scan.speed_of_sound_mmps};
    case MessageId::range:
      return Range{now.scan.start_mm, now.scan.length_mm};
    case MessageId::mode_auto:
      return ModeAuto{now.auto_mode};
    case MessageId::ping_interval:
      return PingInterval{now.interval_ms};
    case MessageId::gain_setting:
      return GainSetting{now.scan.gain};
    case MessageId::transmit_duration:
      return TransmitDuration{transmit_duration_us(now.scan, config_)};
    case MessageId::general_info:
      return GeneralInfo{information.firmware_major,
                         information.firmware_minor,
                         config_.voltage_mv,
                         now.interval_ms,
                         now.scan.gain,
                         now.auto_mode};
    case MessageId::distance_simple:
      return DistanceSimple{pinger_.measured().distance_mm,
                            static_cast<std::uint8_t>(pinger_.measured().confidence_percent)};
    case MessageId::distance:
      return pinger_.measured();
    case MessageId::processor_temperature:
      return ProcessorTemperature{config_.processor_temperature_cdeg};
    case MessageId::pcb_temperature:
      return PcbTemperature{config_.pcb_temperature_cdeg};
    case MessageId::ping_enable:
      return PingEnable{now.enabled};
    case MessageId::profile:
      return Profile{pinger_.measured(), pinger_.profile()};
    default:
      break;
  }
  return id == static_cast<std::uint16_t>(CommonId::protocol_version) ? Report{ProtocolVersion{}}
                                                                      : Report{information};
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const GeneralRequest& command) {
  if (!can_be_requested(command.requested_id)) {
    refuse(asker, id_of(Command{command}), "cannot be requested");
  } else if (is_measurement(command.requested_id) && pinger_.measured().ping_number == 0 &&
             pinger_.settings.enabled && waiting_.size() < most_waiting) {
    waiting_.push_back({asker, command.requested_id, now + longest_wait});
  } else {
    reply(asker, data(command.requested_id));
  }
}

void Device::Impl::answer_waiting(TimePoint now) {
  const bool pinged = pinger_.measured().ping_number > 0;
  const auto rest = std::stable_partition(waiting_.begin(), waiting_.end(),
                                          [&](const Waiting& it) { return pinged || now >= it.due; });
  for (auto it = waiting_.begin(); it != rest; ++it) {
    reply(it->peer, data(it->id));
  }
  waiting_.erase(waiting_.begin(), rest);
}

// ---- Settings

void Device::Impl::accept(const Peer& asker, const Command& command) {
  if (config_.acknowledges) {
    ack(asker, id_of(command));
  }
}

/// Sets a value within its limits. The ack still has the old id as source. False: the value is refused.
template <class Command, class Setting>
bool Device::Impl::set(const Peer& asker, const Command& command, std::uint32_t least, std::uint32_t most,
                       Setting& setting) {
  if (command.value < least || command.value > most) {
    refuse(asker, static_cast<std::uint16_t>(Command::id), value_name(Command::id), command.value, least,
           most);
    return false;
  }
  accept(asker, command);
  setting = static_cast<Setting>(command.value);
  return true;
}

/// In auto mode the head chooses range and gain, and commands change nothing (3.3).
bool Device::Impl::refused_in_auto(const Peer& asker, const Command& command) {
  if (!pinger_.settings.auto_mode) {
    return false;
  }
  ++counters_.refused_in_auto;
  if (!config_.refuses_silently_in_auto) {
    nack(asker, id_of(command), "auto mode is on");
  }
  return true;
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetCommonDeviceId& command) {
  if (command.device_id == broadcast_id) {
    refuse(asker, id_of(Command{command}), "device_id out of range");
    return;
  }
  accept(asker, command);
  id_ = command.device_id;
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetDeviceId& command) {
  set(asker, command, 0, broadcast_id - 1, id_);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetRange& command) {
  if (refused_in_auto(asker, command)) {
    return;
  }
  if (command.length_mm < least_length_mm || command.length_mm > most_range_mm ||
      command.start_mm > most_range_mm - command.length_mm) {
    refuse(asker, id_of(Command{command}),
           command.length_mm < least_length_mm ? "scan_length out of range" : "range out of range");
    return;
  }
  pinger_.settings.scan.start_mm = command.start_mm;
  pinger_.settings.scan.length_mm = command.length_mm;
  accept(asker, command);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetSpeedOfSound& command) {
  set(asker, command, least_speed_mmps, most_speed_mmps, pinger_.settings.scan.speed_of_sound_mmps);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetModeAuto& command) {
  set(asker, command, 0, 1, pinger_.settings.auto_mode);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetPingInterval& command) {
  set(asker, command, 0, UINT16_MAX, pinger_.settings.interval_ms);
  pinger_.hurry();
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetGainSetting& command) {
  if (!refused_in_auto(asker, command)) {
    set(asker, command, 0, most_gain, pinger_.settings.scan.gain);
  }
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const SetPingEnable& command) {
  bool& enabled = pinger_.settings.enabled;
  const bool was_enabled = enabled;
  if (!set(asker, command, 0, 1, enabled)) {
    return;
  }
  if (!enabled) {
    pinger_.cancel();
  } else if (!was_enabled) {
    pinger_.want(now);
  }
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const GotoBootloader& command) {
  accept(asker, command);
  notice("restart by way of the bootloader");
  restart(now + config_.bootloader_silence);
  pinger_.reboot(now + config_.bootloader_silence);
  id_ = config_.id;
  streams_.clear();
  waiting_.clear();
  heard_.reset();
}

// ---- Streams

void Device::Impl::handle(TimePoint, const Peer& asker, const ContinuousStart& command) {
  if (!is_measurement(command.value)) {
    refuse(asker, id_of(Command{command}), "bad continuous request id");
    return;
  }
  accept(asker, command);
  const auto found =
      std::ranges::find_if(streams_, [&](const Stream& it) { return same_client(it.peer, asker); });
  if (found != streams_.end()) {
    *found = {asker, command.value};  // clients repeat the command
    return;
  }
  streams_.push_back({asker, command.value});
  notice(fmt::format("client {} started a stream of {}", clients_.name_of(asker),
                     name_of(static_cast<MessageId>(command.value))));
}

void Device::Impl::handle(TimePoint, const Peer& asker, const ContinuousStop& command) {
  if (!is_measurement(command.value)) {
    refuse(asker, id_of(Command{command}), "bad continuous request id");
    return;
  }
  accept(asker, command);
  std::erase_if(streams_,
                [&](const Stream& it) { return same_client(it.peer, asker) && it.id == command.value; });
}

/// Ignores messages that only heads send, such as a nack. Otherwise two heads on one line would answer each
/// other for ever.
void Device::Impl::handle(TimePoint, const Peer& asker, const Unknown& command) {
  if (command.id > static_cast<std::uint16_t>(CommonId::ascii_text)) {
    refuse(asker, command.id, "bad id");
  }
}

// ---- Time

bool Device::Impl::pinging(TimePoint now) const {
  const bool heard_lately =
      heard_ && (config_.idle_timeout.count() == 0 || now - *heard_ < config_.idle_timeout);
  return pinger_.settings.enabled && !clients_.empty() && (heard_lately || !streams_.empty());
}

void Device::Impl::advance(TimePoint now) {
  forget_silent(now);
  if (pinger_.send(now, id_)) {
    for (const Stream& stream : streams_) {
      reply(stream.peer, data(stream.id));
    }
  }
  answer_waiting(now);
  if (pinging(now)) {
    pinger_.begin(now);
  } else {
    pinger_.cancel();
  }
}

Actions Device::Impl::actions(TimePoint now) {
  Actions actions;
  report(actions);
  pinger_.report(actions);
  std::optional<TimePoint> wake = clients_.next_silence();
  const auto also = [&](std::optional<TimePoint> due) {
    wake = wake && due ? std::min(wake, due) : (due ? due : wake);
  };
  also(pinger_.send_due());
  for (const Waiting& it : waiting_) {
    also(it.due);
  }
  if (heard_ && config_.idle_timeout.count() > 0 && pinging(now) && streams_.empty()) {
    also(*heard_ + config_.idle_timeout);
  }
  if (const auto start = pinging(now) ? pinger_.next_start() : std::nullopt) {
    if (config_.simulated_time) {
      actions.next_ping = pinger_.announced(*start);
    } else {
      also(*start);
    }
  }
  actions.wake_at = wake;
  return actions;
}

std::vector<Counter> Device::Impl::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  const DeviceCounters& count = counters_;
  return {
      {"pings_sent", count.pings_sent, "pings sent, or measured without a stream"},
      {"pings_failed", count.pings_failed, "pings that could not be rendered", Fault::none, Shown::often},
      {"pings_cancelled", count.pings_cancelled, "pings that a command or the end of all clients ended"},
      {"commands", count.commands, "commands that the head accepted or refused"},
      {"refused", count.refused, "commands answered by a nack: values, length or ID (3.1, 3.2)",
       Fault::of_client, Shown::often},
      {"refused_in_auto", count.refused_in_auto, "commands for range or gain in auto mode, ignored (3.3)",
       Fault::of_client, Shown::warns,
       "{} commands for range or gain changed nothing: the head is in auto mode"},
      {"dropped_bytes", count.dropped_bytes,
       "bytes outside frames, ignored; public clients send some on purpose (1)", Fault::none, Shown::often},
      {"bad_checksums", count.bad_checksums, "frames with a wrong checksum, ignored (1)", Fault::of_client,
       Shown::warns, "{} frames had a wrong checksum: the head ignores them"},
      {"other_destinations", count.other_destinations,
       "commands for another device ID, ignored (`device.accepts_any_destination`)", Fault::of_client,
       Shown::warns, "{} commands were for another device"},
      {"clients_dropped", count.clients_dropped, "clients forgotten because of `device.max_clients`",
       Fault::none, Shown::warns, "{} clients were dropped: too many at a time (device.max_clients)"},
      {"locked_out", count.locked_out, "datagrams of other clients, dropped (`lock_to_first`)", Fault::none,
       Shown::warns, "{} datagrams were dropped: another client uses the head (lock_to_first)"},
      {"unheard_bytes", count.unheard_bytes, "bytes that came after goto_bootloader, lost (3.6)"},
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

}  // namespace sonard::ping1d
