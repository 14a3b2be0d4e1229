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

#include "protocol/common/once_warnings.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/ping1d/auto_mode.hpp"
#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "protocol/ping1d/scan.hpp"
#include "protocol/ping1d/tracking.hpp"

namespace sonard::ping1d {
namespace {

using std::chrono::nanoseconds;

/// A request for data before the first ping waits for it, for no longer than clients expect an answer (3.1).
constexpr std::chrono::milliseconds longest_wait{40};
constexpr std::size_t most_waiting = 32;
constexpr std::uint32_t least_speed_mmps = 1'000'000, most_speed_mmps = 2'000'000;

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

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : config_(validated(config)),
        clients_(config_),
        state_(boot_state()),
        cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, start, counters_) {
  }

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece);
  void take(TimePoint, const ClientCame&) {}
  void take(TimePoint, const ClientGone& gone) { forget(gone.who, "disconnected"); }
  void take(TimePoint now, const PingRendered& ping);
  void take(TimePoint now, const PingNotRendered& ping) { cycle_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the head has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead&) {}   // the head has no such sensors
  void take(TimePoint, const PingFed& feed) {
    cycle_.feed(feed.ping && recorded_form(feed.ping->wire) ? feed.ping : std::nullopt);
  }
  void take(TimePoint, const NextPingDue&) { cycle_.grant(); }

  void advance(TimePoint now);
  Actions actions(TimePoint now);

  const DeviceCounters& counters() const { return counters_; }
  std::vector<Counter> counts() const;

 private:
  /// Everything that a restart resets.
  struct State {
    std::uint8_t id;
    Scan scan;
    bool auto_mode = true;
    bool enabled = true;
    std::uint16_t interval_ms;
    Tracking tracking;
    Distance measured;                  ///< the newest ping; ping_number 0: none yet
    std::vector<std::uint8_t> profile;  ///< of that ping
    std::uint32_t pings = 0;
  };
  /// A client's messages after every ping.
  struct Stream {
    Peer peer;
    std::uint16_t id = 0;
  };
  struct Waiting {
    Peer asker;
    std::uint16_t id = 0;
    TimePoint due{};
  };
  /// The ping under way.
  struct Ping {
    Scan scan;
    nanoseconds since_last{};
    std::optional<Distance> recorded;
    Echo echo;  ///< set at the arrival of the image
  };

  State boot_state() const;
  void forget(const Peer& peer, std::string_view why);
  void notice(std::string text) { notices_.push_back({Notice::Level::info, std::move(text)}); }

  // Frames.
  void take_frame(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame);
  void reply(const Peer& asker, const Report& report) {
    clients_.send(asker, encode(report, state_.id), outgoing_);
  }
  void accept(const Peer& asker, const Command& command);
  void send_nack(const Peer& asker, std::uint16_t id, std::string_view text);
  void refuse(const Peer& asker, std::uint16_t id, std::string_view text);
  bool refused_in_auto(const Peer& asker, const Command& command);
  template <class Command>
  bool refused(const Peer& asker, const Command& command, std::uint32_t least, std::uint32_t most,
               std::string_view field);
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

  // Pings.
  bool pinging(TimePoint now) const;
  nanoseconds period() const { return ping_period(state_.scan, state_.interval_ms, config_); }
  std::optional<TimePoint> next_start(TimePoint now) const;
  std::optional<TimePoint> send_due() const;
  void begin_ping(TimePoint now);
  void send_ping(TimePoint now);

  const DeviceConfig config_;
  DeviceCounters counters_;
  Clients clients_;
  State state_;
  std::vector<Stream> streams_;
  std::vector<Waiting> waiting_;
  std::optional<TimePoint> heard_;             ///< newest bytes of any client
  TimePoint silent_until_ = TimePoint::min();  ///< in the future while the head restarts
  PingCycle cycle_;
  Ping ping_;
  TimePoint next_ping_{};  ///< by the rate
  TimePoint wanted_{};     ///< since when pings are wanted
  TimePoint last_start_{};

  // Of the step in progress.
  std::vector<Outgoing> outgoing_;
  std::vector<Notice> notices_;
  OnceWarnings warnings_;
};

Device::Impl::State Device::Impl::boot_state() const {
  return {.id = config_.id,
          .scan = {.length_mm = config_.scan_length_mm, .gain = config_.gain_setting},
          .interval_ms = config_.interval_ms,
          .tracking = Tracking(config_.confidence_window),
          .measured = {.scan_length_mm = config_.scan_length_mm, .gain_setting = config_.gain_setting},
          .profile = std::vector<std::uint8_t>(static_cast<std::size_t>(config_.points))};
}

// ---- Clients and frames

void Device::Impl::take(TimePoint now, const BytesReceived& piece) {
  if (now < silent_until_) {
    counters_.unheard_bytes += piece.bytes.size();
    return;
  }
  if (clients_.locked_against(now, piece.from)) {
    ++counters_.locked_out;
    return;
  }
  if (clients_.find(piece.from) == nullptr) {
    notice(fmt::format("client {} connected", clients_.name_of(piece.from)));
  }
  if (!pinging(now)) {
    wanted_ = now;
  }
  heard_ = now;
  const auto streams = [this](const Peer& peer) {
    return std::ranges::any_of(streams_, [&](const Stream& it) { return same_client(it.peer, peer); });
  };
  Clients::Client& client = clients_.heard(now, piece.from, streams);
  const std::uint64_t dropped = client.input.dropped();
  const std::uint64_t bad_checksums = client.input.bad_checksums();
  client.input.append(now, {piece.bytes.data(), piece.bytes.size()});
  for (auto frame = client.input.front(); frame && now >= silent_until_; frame = client.input.front()) {
    take_frame(now, client.peer, *frame);
    client.input.pop();
  }
  counters_.dropped_bytes += client.input.dropped() - dropped;
  counters_.bad_checksums += client.input.bad_checksums() - bad_checksums;
  if (now < silent_until_) {
    clients_.clear();  // goto_bootloader came
  }
}

void Device::Impl::forget(const Peer& peer, std::string_view why) {
  if (clients_.find(peer) == nullptr) {
    return;
  }
  const auto of_client = [&](const auto& it) { return same_client(it.peer, peer); };
  std::erase_if(streams_, of_client);
  std::erase_if(waiting_, [&](const Waiting& it) { return same_client(it.asker, peer); });
  clients_.remove(peer);
  notice(fmt::format("client {} is gone: {}", clients_.name_of(peer), why));
}

void Device::Impl::take_frame(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame) {
  const FrameHeader header = frame_header(frame);
  if (!config_.accepts_any_destination && header.destination != 0 && header.destination != broadcast_id &&
      header.destination != state_.id) {
    ++counters_.other_destinations;
    return;
  }
  const auto command = decode_command(frame);
  if (!command) {
    refuse(asker, header.message_id, "wrong payload length");
    return;
  }
  counters_.commands += std::holds_alternative<Unknown>(*command) ? 0 : 1;
  clients_.hold(now, asker);
  std::visit([&](const auto& message) { handle(now, asker, message); }, *command);
}

void Device::Impl::accept(const Peer& asker, const Command& command) {
  if (config_.acknowledges) {
    reply(asker, Ack{id_of(command)});
  }
}

void Device::Impl::send_nack(const Peer& asker, std::uint16_t id, std::string_view text) {
  ++counters_.refused;
  reply(asker, Nack{id, std::string(text)});
}

/// @param text a literal
void Device::Impl::refuse(const Peer& asker, std::uint16_t id, std::string_view text) {
  warnings_.warn(text, fmt::format("the client's message {} is refused: {}", id, text), notices_);
  send_nack(asker, id, text);
}

/// In auto mode the head chooses range and gain, and commands change nothing (3.3).
bool Device::Impl::refused_in_auto(const Peer& asker, const Command& command) {
  if (!state_.auto_mode) {
    return false;
  }
  ++counters_.refused_in_auto;
  if (!config_.refuses_silently_in_auto) {
    send_nack(asker, id_of(command), "auto mode is on");
  }
  return true;
}

template <class Command>
bool Device::Impl::refused(const Peer& asker, const Command& command, std::uint32_t least, std::uint32_t most,
                           std::string_view field) {
  if (command.value >= least && command.value <= most) {
    return false;
  }
  warnings_.warn(
      field,
      fmt::format("the client's {} {} is refused: expected {} to {}", field, command.value, least, most),
      notices_);
  send_nack(asker, static_cast<std::uint16_t>(Command::id), fmt::format("{} out of range", field));
  return true;
}

// ---- Requests

Report Device::Impl::data(std::uint16_t id) const {
  const State& state = state_;
  const DeviceInformation& information = config_.information;
  switch (static_cast<MessageId>(id)) {
    case MessageId::firmware_version:
      return FirmwareVersion{.major = information.firmware_major, .minor = information.firmware_minor};
    case MessageId::device_id:
      return DeviceId{state.id};
    case MessageId::voltage_5:
      return Voltage5{config_.voltage_mv};
    case MessageId::speed_of_sound:
      return SpeedOfSound{state.scan.speed_of_sound_mmps};
    case MessageId::range:
      return Range{state.scan.start_mm, state.scan.length_mm};
    case MessageId::mode_auto:
      return ModeAuto{state.auto_mode};
    case MessageId::ping_interval:
      return PingInterval{state.interval_ms};
    case MessageId::gain_setting:
      return GainSetting{state.scan.gain};
    case MessageId::transmit_duration:
      return TransmitDuration{transmit_duration_us(state.scan, config_)};
    case MessageId::general_info:
      return GeneralInfo{information.firmware_major,
                         information.firmware_minor,
                         config_.voltage_mv,
                         state.interval_ms,
                         state.scan.gain,
                         state.auto_mode};
    case MessageId::distance_simple:
      return DistanceSimple{state.measured.distance_mm,
                            static_cast<std::uint8_t>(state.measured.confidence_percent)};
    case MessageId::distance:
      return state.measured;
    case MessageId::processor_temperature:
      return ProcessorTemperature{config_.processor_temperature_cdeg};
    case MessageId::pcb_temperature:
      return PcbTemperature{config_.pcb_temperature_cdeg};
    case MessageId::ping_enable:
      return PingEnable{state.enabled};
    case MessageId::profile: {
      auto profile = measurement<Profile>(state.measured);
      profile.data = state.profile;
      return profile;
    }
    default:
      break;
  }
  return id == static_cast<std::uint16_t>(CommonId::protocol_version) ? Report{ProtocolVersion{}}
                                                                      : Report{information};
}

namespace {

bool is_measurement(std::uint16_t id) {
  const auto message = static_cast<MessageId>(id);
  return message == MessageId::distance_simple || message == MessageId::distance ||
         message == MessageId::profile;
}

}  // namespace

void Device::Impl::handle(TimePoint now, const Peer& asker, const GeneralRequest& command) {
  if (!can_be_requested(command.requested_id)) {
    refuse(asker, id_of(Command{command}), "cannot be requested");
  } else if (is_measurement(command.requested_id) && state_.pings == 0 && state_.enabled &&
             waiting_.size() < most_waiting) {
    waiting_.push_back({asker, command.requested_id, now + longest_wait});
  } else {
    reply(asker, data(command.requested_id));
  }
}

void Device::Impl::answer_waiting(TimePoint now) {
  const auto rest = std::stable_partition(
      waiting_.begin(), waiting_.end(), [&](const Waiting& it) { return state_.pings > 0 || now >= it.due; });
  for (auto it = waiting_.begin(); it != rest; ++it) {
    reply(it->asker, data(it->id));
  }
  waiting_.erase(waiting_.begin(), rest);
}

// ---- Settings

void Device::Impl::handle(TimePoint, const Peer& asker, const SetCommonDeviceId& command) {
  if (command.device_id == broadcast_id) {
    refuse(asker, id_of(Command{command}), "device_id out of range");
    return;
  }
  accept(asker, command);
  state_.id = command.device_id;
}

/// The ack still has the old id as source.
void Device::Impl::handle(TimePoint, const Peer& asker, const SetDeviceId& command) {
  if (!refused(asker, command, 0, broadcast_id - 1, "device_id")) {
    accept(asker, command);
    state_.id = command.value;
  }
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
  state_.scan.start_mm = command.start_mm;
  state_.scan.length_mm = command.length_mm;
  accept(asker, command);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetSpeedOfSound& command) {
  if (!refused(asker, command, least_speed_mmps, most_speed_mmps, "speed_of_sound")) {
    state_.scan.speed_of_sound_mmps = command.value;
    accept(asker, command);
  }
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetModeAuto& command) {
  if (!refused(asker, command, 0, 1, "mode_auto")) {
    state_.auto_mode = command.value != 0;
    accept(asker, command);
  }
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetPingInterval& command) {
  state_.interval_ms = command.value;
  next_ping_ = std::min(next_ping_, last_start_ + period());
  accept(asker, command);
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetGainSetting& command) {
  if (!refused_in_auto(asker, command) && !refused(asker, command, 0, most_gain, "gain_setting")) {
    state_.scan.gain = command.value;
    accept(asker, command);
  }
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const SetPingEnable& command) {
  if (refused(asker, command, 0, 1, "ping_enabled")) {
    return;
  }
  const bool enable = command.value != 0;
  if (enable && !state_.enabled) {
    wanted_ = now;
  } else if (!enable) {
    cycle_.cancel();
  }
  state_.enabled = enable;
  accept(asker, command);
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const GotoBootloader& command) {
  accept(asker, command);
  notice("restart by way of the bootloader");
  silent_until_ = now + config_.bootloader_silence;
  cycle_.reboot(silent_until_);
  state_ = boot_state();
  streams_.clear();
  waiting_.clear();
  heard_.reset();
  // take() clears the clients later, because the input of one is being read.
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

// ---- Pings

bool Device::Impl::pinging(TimePoint now) const {
  const bool heard_lately =
      heard_ && (config_.idle_timeout.count() == 0 || now - *heard_ < config_.idle_timeout);
  return state_.enabled && !clients_.empty() && (heard_lately || !streams_.empty());
}

std::optional<TimePoint> Device::Impl::next_start(TimePoint now) const {
  return pinging(now) ? cycle_.next_start(std::max(wanted_, cycle_.answered_at()), next_ping_) : std::nullopt;
}

/// When the image can be sent; nullopt if there is no image.
std::optional<TimePoint> Device::Impl::send_due() const {
  if (!cycle_.rendered()) {
    return std::nullopt;
  }
  return cycle_.job().transmit_time + (config_.simulated_time ? nanoseconds{0} : cycle_.job().listening_time);
}

void Device::Impl::begin_ping(TimePoint now) {
  const std::optional<TimePoint> start = next_start(now);
  if (!start || now < *start || !cycle_.granted()) {
    return;
  }
  ping_ = {.scan = state_.scan, .since_last = now - last_start_, .recorded = {}, .echo = {}};
  PingJob job;
  if (const std::optional<ReplayedPing>& fed = cycle_.fed()) {
    ping_.recorded = recorded_form(fed->wire);
    job = make_job(*fed, *ping_.recorded);
    if (!state_.auto_mode) {
      job.differences = differences(state_.scan, *ping_.recorded);
    }
  } else {
    job = make_job(state_.scan, config_);
  }
  job.period = std::max(period(), job.listening_time);
  last_start_ = now;
  // Keeps the phase; after a late call at most one missed period is caught up.
  next_ping_ = std::max(std::max(next_ping_, now - job.period) + job.period, now + job.listening_time);
  cycle_.begin(std::move(job), now);
}

void Device::Impl::take(TimePoint now, const PingRendered& ping) {
  if (!cycle_.on_image(now, ping.image.number)) {
    return;
  }
  const std::vector<float> strength = amplitudes(ping.image);
  if (strength.empty() || strength.size() != static_cast<std::size_t>(cycle_.job().bins()) ||
      (ping_.recorded && strength.size() != ping.image.u8.size())) {
    cycle_.fail();
  } else if (ping_.recorded) {
    ping_.echo.profile = ping.image.u8;
  } else {
    ping_.echo = find_echo(strength, ping_.scan, config_.points, 1e3 * config_.least_range_m);
  }
}

void Device::Impl::send_ping(TimePoint now) {
  const std::optional<TimePoint> due = send_due();
  if (!due || now < *due) {
    return;
  }
  State& state = state_;
  if (ping_.recorded) {
    state.measured = *ping_.recorded;
  } else {
    state.tracking.add(ping_.echo, ping_.since_last);
    state.measured = {.distance_mm = state.tracking.distance_mm(),
                      .confidence_percent = state.tracking.confidence_percent(),
                      .transmit_duration_us = transmit_duration_us(ping_.scan, config_),
                      .scan_start_mm = ping_.scan.start_mm,
                      .scan_length_mm = ping_.scan.length_mm,
                      .gain_setting = ping_.scan.gain};
  }
  state.measured.ping_number = ++state.pings;
  state.profile = ping_.echo.profile;
  const double sound_speed_mps = ping_.recorded ? cycle_.job().sound_speed_mps : ping_.scan.sound_speed_mps();
  cycle_.put_on_wire(record_of(state.measured, state.profile, sound_speed_mps, state.id));
  ++counters_.pings_sent;
  for (const Stream& stream : streams_) {
    reply(stream.peer, data(stream.id));
  }
  if (state.auto_mode && !ping_.recorded) {
    state.scan = next_auto_scan(state.scan, ping_.echo, config_);
  }
}

// ---- Time

void Device::Impl::advance(TimePoint now) {
  for (const Peer& peer : clients_.silent(now)) {
    forget(peer, "timed out");
  }
  send_ping(now);
  answer_waiting(now);
  if (!pinging(now)) {
    cycle_.cancel();
  }
  begin_ping(now);
}

Actions Device::Impl::actions(TimePoint now) {
  Actions actions;
  actions.send = std::exchange(outgoing_, {});
  actions.notices = std::exchange(notices_, {});
  cycle_.report(actions);
  actions.nobody_there = clients_.empty();
  std::optional<TimePoint> wake = clients_.next_silence();
  const auto also = [&](std::optional<TimePoint> due) {
    wake = wake && due ? std::min(wake, due) : (due ? due : wake);
  };
  also(send_due());
  for (const Waiting& it : waiting_) {
    also(it.due);
  }
  if (heard_ && config_.idle_timeout.count() > 0 && pinging(now) && streams_.empty()) {
    also(*heard_ + config_.idle_timeout);
  }
  if (const std::optional<TimePoint> start = next_start(now)) {
    if (config_.simulated_time) {
      actions.next_ping = NextPing{*start, period(), listening_time(state_.scan)};
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
       "bytes outside frames, ignored; public clients send some on purpose (1)", Fault::none,
       Shown::often},
      {"bad_checksums", count.bad_checksums, "frames with a wrong checksum, ignored (1)", Fault::of_client,
       Shown::warns, "{} frames had a wrong checksum: the head ignores them"},
      {"other_destinations", count.other_destinations,
       "commands for another device ID, ignored (`device.accepts_any_destination`)", Fault::of_client,
       Shown::warns, "{} commands were for another device"},
      {"clients_dropped", clients_.dropped(), "clients forgotten because of `device.max_clients`",
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
