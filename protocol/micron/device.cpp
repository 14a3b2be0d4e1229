// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/device.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "protocol/micron/codec.hpp"
#include "protocol/micron/scanner.hpp"
#include "protocol/micron/settings_text.hpp"

namespace sonard::micron {
namespace {

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument(std::string("micron device: ") + what);
  }
}

const DeviceConfig& validated(const DeviceConfig& config) {
  using std::chrono::nanoseconds;
  using std::chrono::seconds;
  constexpr nanoseconds zero{0};
  require(config.node >= 1 && config.node < client_node, "node must be 1..254");
  require(config.water_sound_speed_mps > 0.0, "water_sound_speed_mps must be positive");
  require(config.boot_time >= zero && config.boot_time < seconds{1}, "boot_time must be less than 1 s");
  require(config.least_centring_time >= zero && config.least_centring_time <= seconds{15},
          "least_centring_time must be 0..15 s");
  require(config.seek_speed_rad_s > 0.0, "seek_speed_rad_s must be positive");
  require(config.alive_period > zero, "alive_period must be positive");
  require(config.request_cap >= 1 && config.request_cap <= 100, "request_cap must be 1..100");
  require(config.reconfiguration_time >= zero, "reconfiguration_time must not be negative");
  require(config.reposition_limit >= zero, "reposition_limit must not be negative");
  require(config.baud > 0, "baud must be positive");
  require(config.line_overhead >= zero, "line_overhead must not be negative");
  require(!config.line_period || *config.line_period >= zero, "line_period must not be negative");
  return config;
}

}  // namespace

std::string_view to_string(HeadState state) {
  switch (state) {
    case HeadState::booting:
      return "booting";
    case HeadState::centring:
      return "centring";
    case HeadState::without_parameters:
      return "without_parameters";
    case HeadState::ready:
      return "ready";
    case HeadState::scanning:
      return "scanning";
  }
  return "unknown";
}

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : config_(validated(config)),
        warnings_(config_),
        scanner_(config_, start, counters_),
        input_(max_command_frame_size),
        clock_zero_(start),
        next_alive_(start) {}

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece);
  void take(TimePoint, const ClientCame&) {}
  void take(TimePoint, const ClientGone&) { input_.clear(); }
  void take(TimePoint now, const PingRendered& ping) { scanner_.on_image(now, ping.image); }
  void take(TimePoint now, const PingNotRendered& ping) { scanner_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the head has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead&) {}   // the head has no such sensors
  void take(TimePoint, const PingFed& feed) { scanner_.feed(feed.ping); }
  void take(TimePoint, const NextPingDue&) { scanner_.next_ping_due(); }

  void power_cycle(TimePoint now);
  void advance(TimePoint now);
  Actions actions(TimePoint now);

  Scanner& scanner() { return scanner_; }
  const DeviceCounters& counters() const { return counters_; }
  HeadState state(TimePoint now) const;

 private:
  bool booting(TimePoint now) const { return now < boot_end_; }
  std::optional<TimePoint> next_deadline() const;
  void notice_state(TimePoint now);
  void read_frames(TimePoint now);
  bool take_frame(TimePoint now, const FrameBuffer::Frame& frame);
  bool has_parameters();

  // One overload for each command.
  void handle(TimePoint, const SendVersion&);
  void handle(TimePoint, const SendBBUser&);
  void handle(TimePoint now, const Reboot&) { power_cycle(now); }
  void handle(TimePoint, const StopAlives&) { alives_stopped_ = true; }
  void handle(TimePoint, const SendFpgaVersion&) { send(FpgaVersionData{}); }
  void handle(TimePoint, const SendFpgaCalData&) { send(FpgaCalData{}); }
  void handle(TimePoint now, const SendData& command);
  void handle(TimePoint now, const HeadCommand& command);
  void handle(TimePoint now, const GainCommand& command);
  void handle(TimePoint now, const ReverseCommand& command);
  void handle(TimePoint, const Unknown&) {}  // never called: take_frame() drops unknown commands

  void send(const Report& report) { outgoing_.push_back(encode(report, config_.node)); }
  void send_alive(TimePoint now);
  void send_due_alive(TimePoint now);
  std::uint8_t head_info(TimePoint now) const;

  const DeviceConfig config_;
  DeviceCounters counters_;
  SettingsWarnings warnings_;
  Scanner scanner_;
  FrameBuffer input_;

  TimePoint boot_end_{};    ///< in the future while the head boots
  TimePoint clock_zero_{};  ///< time at which the clock of the head was or would have been 0
  TimePoint next_alive_{};
  bool alives_stopped_ = false;
  bool sent_config_ = false;
  std::vector<std::vector<std::uint8_t>> outgoing_;  ///< frames of the step in progress

  std::vector<Notice> notices_;
  std::optional<HeadState> noticed_state_;
  std::optional<TimePoint> idle_since_;
};

void Device::Impl::power_cycle(TimePoint now) {
  ++counters_.boots;
  boot_end_ = now + config_.boot_time;
  clock_zero_ = now;
  next_alive_ = boot_end_;
  alives_stopped_ = false;
  sent_config_ = false;
  scanner_.restart(now, boot_end_);
}

// ---- Commands

void Device::Impl::take(TimePoint now, const BytesReceived& piece) {
  if (booting(now)) {
    counters_.unheard_bytes += piece.bytes.size();
    return;
  }
  input_.append(now, {piece.bytes.data(), piece.bytes.size()});
  read_frames(now);
}

void Device::Impl::read_frames(TimePoint now) {
  while (const auto frame = input_.front(now)) {
    if (take_frame(now, *frame)) {
      input_.pop();
    } else {
      input_.reject();
    }
    if (booting(now)) {
      input_.clear();  // bytes after the reboot command are lost
    }
  }
  counters_.dropped_bytes = input_.dropped();
}

/// False if the frame is invalid and may contain the start of another. A whole frame has a correct length, so
/// it is consumed in any case.
bool Device::Impl::take_frame(TimePoint now, const FrameBuffer::Frame& frame) {
  const FrameHeader header = frame_header(frame.bytes);
  if (header.rx_node != config_.node && header.rx_node != broadcast_node) {
    ++counters_.wrong_node;
    return !frame.cut;
  }
  const auto command = decode_command(frame.bytes);
  if (!command) {
    ++counters_.bad_frames;
    return !frame.cut;
  }
  if (std::holds_alternative<Unknown>(*command)) {
    ++counters_.unknown_type;
    return !frame.cut;
  }
  ++counters_.commands;
  counters_.cut_frames += frame.cut ? 1 : 0;
  std::visit([&](const auto& message) { handle(now, message); }, *command);
  return true;
}

void Device::Impl::handle(TimePoint, const SendVersion&) {
  VersionData version = config_.version;
  version.node = config_.node;
  send(version);
}

void Device::Impl::handle(TimePoint, const SendBBUser&) {
  sent_config_ = true;
  BBUserData blocks;
  blocks.older_half_duplex = config_.half_duplex ? 1 : 0;
  if (config_.user_blocks == UserBlocks::older) {
    blocks.kind = 0;
    blocks.dst_half_duplex.reset();
  } else {
    blocks.dst_half_duplex = blocks.older_half_duplex;
  }
  send(blocks);
  if (config_.user_blocks == UserBlocks::dst) {
    send(FpgaCalData{});  // unrequested, in this order
    send(FpgaVersionData{});
  }
}

bool Device::Impl::has_parameters() {
  if (scanner_.parameters()) {
    return true;
  }
  ++counters_.not_ready;
  return false;
}

void Device::Impl::handle(TimePoint now, const SendData& command) {
  if (config_.clock_follows_client && command.time_ms != 0) {
    clock_zero_ = now - std::chrono::milliseconds{command.time_ms};
  }
  if (has_parameters()) {
    scanner_.request(now);
  }
}

void Device::Impl::handle(TimePoint now, const HeadCommand& command) {
  scanner_.configure(now, command);
  sent_config_ = true;
  if (!config_.plays_back) {
    counters_.out_of_range += warnings_.check(command, notices_) ? 1 : 0;
  }
  if (config_.alive_after_head_command && !alives_stopped_) {
    send_alive(now);
  }
}

void Device::Impl::handle(TimePoint, const GainCommand& command) {
  if (has_parameters()) {
    if (!config_.plays_back) {
      counters_.out_of_range += warnings_.check_gain(command.values.gain[0], notices_) ? 1 : 0;
    }
    scanner_.set_gain(command.values);
  }
}

void Device::Impl::handle(TimePoint, const ReverseCommand&) {
  if (has_parameters()) {
    scanner_.reverse();
  }
}

// ---- Time

HeadState Device::Impl::state(TimePoint now) const {
  if (booting(now)) {
    return HeadState::booting;
  }
  if (!scanner_.centred(now)) {
    return HeadState::centring;
  }
  if (!scanner_.parameters()) {
    return HeadState::without_parameters;
  }
  return scanner_.owed() > 0 ? HeadState::scanning : HeadState::ready;
}

std::uint8_t Device::Impl::head_info(TimePoint now) const {
  using namespace head_info_bits;
  const HeadState state_now = state(now);
  const bool seeking = state_now == HeadState::centring;
  unsigned info = motor_on | (seeking ? head_info_bits::centring | motoring : centred);
  if (scanner_.turning(now)) {
    info |= motoring;
  }
  if (scanner_.position(now) != bearing_ahead && (seeking || config_.direction_bit_kept)) {
    info |= off_centre;
  }
  if (!scanner_.parameters()) {
    info |= no_parameters;
  } else if (state_now == HeadState::scanning) {
    info |= scanning;
  }
  if (sent_config_) {
    info |= sent_config;
  }
  return static_cast<std::uint8_t>(info);
}

void Device::Impl::send_alive(TimePoint now) {
  Alive alive;
  alive.head_info = head_info(now);
  alive.needs_parameters = alive.has(head_info_bits::no_parameters) ? 0x80 : 0;
  alive.time_ms = static_cast<std::uint32_t>((now - clock_zero_) / std::chrono::milliseconds{1});
  alive.position = static_cast<std::uint16_t>(scanner_.position(now));
  send(alive);
  ++counters_.alives_sent;
}

void Device::Impl::send_due_alive(TimePoint now) {
  if (now < next_alive_) {
    return;
  }
  const bool quiet = alives_stopped_ || (!config_.alive_while_scanning && state(now) == HeadState::scanning);
  if (!quiet) {
    send_alive(now);
  }
  // Keeps the phase; alives that a late caller missed are skipped.
  next_alive_ += config_.alive_period * ((now - next_alive_) / config_.alive_period + 1);
}

void Device::Impl::advance(TimePoint now) {
  if (booting(now)) {
    return;
  }
  read_frames(now);  // a cut frame may have become acceptable by now
  if (booting(now)) {
    return;
  }
  send_due_alive(now);
  scanner_.advance(now, outgoing_);
}

Actions Device::Impl::actions(TimePoint now) {
  notice_state(now);
  Actions actions;
  for (std::vector<std::uint8_t>& frame : std::exchange(outgoing_, {})) {
    actions.send.push_back({Outgoing::To::everybody, {}, SharedBytes(std::move(frame))});
  }
  actions.notices = std::exchange(notices_, {});
  scanner_.report(actions);
  actions.wake_at = next_deadline();
  return actions;
}

/// Reports the change from `scanning` to `ready` only after 2 s without requests, because with some clients
/// the head is briefly ready between two lines of a scan.
void Device::Impl::notice_state(TimePoint now) {
  constexpr std::chrono::seconds idle_after{2};
  const HeadState state_now = state(now);
  if (state_now != HeadState::ready || noticed_state_ != HeadState::scanning) {
    idle_since_.reset();
  } else if (!idle_since_) {
    idle_since_ = now;
  }
  if (noticed_state_ == state_now || (idle_since_ && now - *idle_since_ < idle_after)) {
    return;
  }
  notices_.push_back({Notice::Level::info, std::string(to_string(state_now))});
  noticed_state_ = state_now;
}

std::optional<TimePoint> Device::Impl::next_deadline() const {
  TimePoint next = next_alive_;  // this is also the end of booting
  for (const auto& due : {scanner_.next_deadline(), input_.next_deadline()}) {
    next = std::min(next, due.value_or(next));
  }
  return std::max(next, boot_end_);
}

// ---- Device

Device::Device(const DeviceConfig& config, TimePoint start) : impl_(std::make_unique<Impl>(config, start)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  Actions actions = impl_->actions(now);
  actions.nobody_there = std::holds_alternative<ClientGone>(event);
  return actions;
}

PingProgress Device::progress() const {
  const DeviceCounters& count = counters();
  return {.sent = count.pings_sent, .ended = count.pings_ended(), .messages = count.pings_sent};
}

std::vector<Counter> Device::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  const DeviceCounters& count = counters();
  return {
      {"lines_sent", count.pings_sent, "lines sent"},
      {"pings_failed", count.pings_failed, "lines that could not be rendered"},
      {"pings_cancelled", count.pings_cancelled, "lines that new parameters or a reboot ended"},
      {"commands", count.commands, "commands that the head accepted"},
      {"dropped_bytes", count.dropped_bytes, "bytes outside frames (2.3), also noise on the line, ignored",
       Fault::of_client, Shown::warns, "{} bytes from clients belonged to no command"},
      {"bad_frames", count.bad_frames, "commands with a wrong length or form (5), ignored", Fault::of_client,
       Shown::warns, "{} commands could not be decoded"},
      {"cut_frames", count.cut_frames, "commands shorter than they state, obeyed (2.4)"},
      {"wrong_node", count.wrong_node, "commands for another node (`device.node`), ignored", Fault::of_client,
       Shown::warns, "{} commands were for another node"},
      {"unknown_type", count.unknown_type, "messages of unknown type, ignored (3)", Fault::of_client,
       Shown::warns, "{} messages had an unknown type: the head ignores them"},
      {"out_of_range", count.out_of_range,
       "head commands with a gain above 210, `ad_interval` 0, no bins or more than 1500, clamped (4)",
       Fault::of_client, Shown::once},
      {"not_ready", count.not_ready, "requests, gains and reversals without parameters, ignored (7.2)",
       Fault::of_client, Shown::warns, "{} requests came before the parameters"},
      {"unheard_bytes", count.unheard_bytes, "bytes that came while the head booted, lost (7.1)"},
      {"requests_beyond_cap", count.requests_beyond_cap,
       "requested lines beyond `device.request_cap`, not owed; usual with many drivers (8.2)"},
      {"boots", count.boots, "reboots"}};
}

void Device::power_cycle(TimePoint now) {
  impl_->power_cycle(now);
}
void Device::lose_step() {
  impl_->scanner().lose_step();
}
const DeviceCounters& Device::counters() const {
  return impl_->counters();
}
HeadState Device::state(TimePoint now) const {
  return impl_->state(now);
}

}  // namespace sonard::micron
