// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/device.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/limits.hpp"
#include "protocol/ping360/scanner.hpp"
#include "protocol/ping360/settings_text.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

constexpr std::string_view not_recognised = "command not recognised";

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument(std::string("ping360 device: ") + what);
  }
}

bool is_device_id(int id) {
  return id >= 1 && id < broadcast_id;
}

const DeviceConfig& validated(const DeviceConfig& config) {
  constexpr std::chrono::nanoseconds zero{0};
  require(is_device_id(config.id), "id must be 1..254");
  require(config.information.device_revision > 0, "information.device_revision must not be 0");
  require(config.water_sound_speed_mps > 0.0, "water_sound_speed_mps must be positive");
  require(config.bearing_offset >= 0 && config.bearing_offset < gradians_per_turn,
          "bearing_offset must be 0..399");
  require(config.ping_overhead >= zero, "ping_overhead must not be negative");
  require(config.time_per_gradian >= zero, "time_per_gradian must not be negative");
  require(config.time_scale >= 0.0 && config.time_scale <= 1000.0, "time_scale must be 0..1000");
  require(config.reset_silence >= zero, "reset_silence must not be negative");
  require(config.bootloader_silence >= zero, "bootloader_silence must not be negative");
  const auto invalid = invalid_field(config);
  require(!invalid, invalid.value_or("").c_str());
  return config;
}

}  // namespace

class Device::Impl final : public Head {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : Head(config_, config.id, !config.ignores_other_destinations, counters_),
        config_(validated(config)),
        scanner_(config_, start, counters_) {}

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece) { receive(now, piece); }
  void take(TimePoint, const ClientCame&) {}
  void take(TimePoint now, const ClientGone& gone) { Head::take(now, gone); }
  void take(TimePoint now, const PingRendered& ping) { scanner_.on_image(now, ping.image); }
  void take(TimePoint now, const PingNotRendered& ping) { scanner_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the head has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // the head pings in air, too
  void take(TimePoint, const SensorsRead&) {}   // the head has no such sensors
  void take(TimePoint, const PingFed& feed) { scanner_.feed(feed.ping); }
  void take(TimePoint, const NextPingDue&) { scanner_.next_ping_due(); }

  void advance(TimePoint now);
  Actions actions();

  const DeviceCounters& counters() const { return counters_; }
  std::uint8_t id() const { return id_; }

 private:
  using Client = Clients::Client;

  // The clients' side.
  bool keeps(const Peer& peer) const override;
  bool on_empty(TimePoint now, Client& client) override;
  void between_frames(TimePoint now, Client& client) override;
  bool obey(TimePoint now, const Peer& asker, std::span<const std::uint8_t> frame) override {
    return Head::obey(now, asker, decode_command(frame),
                      [&](const auto& message) { handle(now, asker, message); });
  }
  void on_forget(TimePoint now, const Peer& peer, std::string_view why) override;

  // Answers.
  void reply(const Peer& asker, const Report& report) { send(asker, encode(report, id_)); }
  template <class Command>
  bool refused(const Peer& asker, const Command& command);
  void end_scan(TimePoint now, std::string_view why);
  void set_id(const Peer& asker, std::uint16_t order, std::uint8_t device_id);

  // One overload for each command.
  void handle(TimePoint now, const Peer& asker, const GeneralRequest& command);
  void handle(TimePoint now, const Peer& asker, const SetCommonDeviceId& command);
  void handle(TimePoint now, const Peer& asker, const SetDeviceId& command);
  void handle(TimePoint now, const Peer& asker, const Reset& command);
  void handle(TimePoint now, const Peer& asker, const Transducer& command);
  void handle(TimePoint now, const Peer& asker, const AutoTransmit& command);
  void handle(TimePoint now, const Peer& asker, const MotorOff& command);
  void handle(TimePoint now, const Peer& asker, const Unknown& command);

  const DeviceConfig config_;
  DeviceCounters counters_;
  Scanner scanner_;
  bool said_angle_400_ = false;
};

// ---- Clients

/// The starter of a scan may only listen.
bool Device::Impl::keeps(const Peer& peer) const {
  const auto scan = scanner_.running_scan();
  return scan && same_client(scan->first, peer);
}

void Device::Impl::on_forget(TimePoint now, const Peer& peer, std::string_view why) {
  if (keeps(peer)) {
    end_scan(now, why);
  }
  scanner_.forget(now, peer);
}

/// An empty datagram stands for a break of the serial line behind a bridge. A 'U' between frames stands for a
/// break if the line does not report breaks (4.3, 4.4).
bool Device::Impl::on_empty(TimePoint now, Client& client) {
  if (!clients_.is_serial(client.peer)) {
    client.input.clear();
    end_scan(now, "empty datagram received");
  }
  return true;
}

void Device::Impl::between_frames(TimePoint now, Client& client) {
  if (client.input.take_baud_bytes() && clients_.is_serial(client.peer)) {
    end_scan(now, "break received");
  }
}

template <class Command>
bool Device::Impl::refused(const Peer& asker, const Command& command) {
  const auto field = out_of_range(command, config_);
  if (field) {
    refuse(asker, id_of(command), field->field, field->value, field->least, field->most);
  }
  return field.has_value();
}

void Device::Impl::end_scan(TimePoint now, std::string_view why) {
  if (scanner_.running_scan()) {
    scanner_.end_scan(now);
    notice(fmt::format("auto scan ended: {}", why));
  }
}

// ---- Commands

void Device::Impl::handle(TimePoint now, const Peer& asker, const GeneralRequest& command) {
  switch (static_cast<MessageId>(command.requested_id)) {
    case MessageId::device_information:
      reply(asker, config_.information);
      return;
    case MessageId::protocol_version:
      reply(asker, ProtocolVersion{});
      return;
    case MessageId::device_data:
      reply(asker, scanner_.state(now));
      return;
    case MessageId::set_device_id:
      reply(asker, SetDeviceId{id_});
      return;
    case MessageId::auto_device_data:
      if (const auto state = scanner_.scan_state(now)) {
        reply(asker, *state);
        return;
      }
      break;
    default:
      break;
  }
  refuse(asker, id_of(command), "cannot be requested");
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetCommonDeviceId& command) {
  if (config_.obeys_set_common_device_id) {
    set_id(asker, id_of(command), command.device_id);
  } else {
    refuse(asker, id_of(command), not_recognised);
  }
}

void Device::Impl::handle(TimePoint, const Peer& asker, const SetDeviceId& command) {
  set_id(asker, static_cast<std::uint16_t>(SetDeviceId::id), command.device_id);
}

/// The answer still has the old id as source.
void Device::Impl::set_id(const Peer& asker, std::uint16_t order, std::uint8_t device_id) {
  if (is_device_id(device_id)) {
    ack(asker, order);
    id_ = device_id;
  } else {
    const bool of_head = order == static_cast<std::uint16_t>(SetDeviceId::id);
    refuse(asker, order, of_head ? "id out of range" : "device_id out of range");
  }
}

void Device::Impl::handle(TimePoint now, const Peer&, const Reset& command) {
  end_scan(now, "reset");
  scanner_.restart(now);
  ++counters_.resets;
  notice(command.bootloader != 0 ? "reset into the bootloader" : "reset");
  Head::restart(now + (command.bootloader != 0 ? config_.bootloader_silence : config_.reset_silence));
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const Transducer& command) {
  if (refused(asker, command)) {
    return;
  }
  if (command.angle == gradians_per_turn && !std::exchange(said_angle_400_, true)) {
    notice("the client's angle 400 is taken as 0");
  }
  if (scanner_.running_scan()) {
    notice("auto scan ended: transducer command received");
  }
  scanner_.command(now, asker, command);
}

/// Repeated commands of a client are not logged, because some clients repeat them often.
void Device::Impl::handle(TimePoint now, const Peer& asker, const AutoTransmit& command) {
  if (refused(asker, command)) {
    return;
  }
  const auto before = scanner_.running_scan();
  scanner_.scan(now, asker, command);
  if (!before || before->second != command || !same_client(before->first, asker)) {
    notice(fmt::format("auto scan by client {}: {}", clients_.name_of(asker), scan_text(command)));
  }
}

void Device::Impl::handle(TimePoint now, const Peer& asker, const MotorOff& command) {
  end_scan(now, "motor_off");
  scanner_.stop(now);
  ack(asker, id_of(command));
}

/// Ignores messages that only heads send, such as a nack. Otherwise two heads on one line would answer each
/// other for ever.
void Device::Impl::handle(TimePoint, const Peer& asker, const Unknown& command) {
  if (command.id > static_cast<std::uint16_t>(MessageId::ascii_text)) {
    refuse(asker, command.id, not_recognised);
  }
}

// ---- Time

void Device::Impl::advance(TimePoint now) {
  forget_silent(now);
  std::vector<Scanner::Answer> answers;
  scanner_.advance(now, id_, answers);
  for (const Scanner::Answer& answer : answers) {
    send(answer.to, answer.frame);
  }
}

Actions Device::Impl::actions() {
  Actions actions;
  report(actions);
  scanner_.report(actions);
  const auto work = scanner_.next_deadline();
  const auto silence = clients_.next_silence();
  actions.wake_at = work && silence ? std::min(work, silence) : (work ? work : silence);
  return actions;
}

// ---- Device

Device::Device(const DeviceConfig& config, TimePoint start) : impl_(std::make_unique<Impl>(config, start)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  return impl_->actions();
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
      {"pings_sent", count.pings_sent, "pings sent"},
      {"pings_failed", count.pings_failed, "pings that could not be rendered", Fault::none, Shown::often},
      {"pings_cancelled", count.pings_cancelled, "pings that a command or the end of a scan ended"},
      {"commands", count.commands, "commands that the head accepted or refused"},
      {"refused", count.refused, "commands answered by a nack: values, length or ID (3.8)", Fault::of_client,
       Shown::often},
      {"commands_joined", count.commands_joined, "repeated commands that share an answer (3.2)"},
      {"commands_dropped", count.commands_dropped,
       "commands that came while `device.queue_length` others waited; the oldest is dropped (3.2)",
       Fault::of_client, Shown::often},
      {"dropped_bytes", count.dropped_bytes,
       "bytes outside frames, ignored; public clients send some on purpose (1.1)", Fault::none, Shown::often},
      {"bad_checksums", count.bad_checksums, "frames with a wrong checksum, ignored (1.1)", Fault::of_client,
       Shown::warns, "{} frames had a wrong checksum: the head ignores them"},
      {"other_destinations", count.other_destinations,
       "commands for another device ID, ignored (`device.ignores_other_destinations`)", Fault::of_client,
       Shown::warns, "{} commands were for another device"},
      {"clients_dropped", count.clients_dropped, "clients forgotten because of `device.max_clients`",
       Fault::none, Shown::warns, "{} clients were dropped: too many at a time (device.max_clients)"},
      {"locked_out", count.locked_out, "datagrams of other clients, dropped (`lock_to_first`)", Fault::none,
       Shown::warns, "{} datagrams were dropped: another client uses the head (lock_to_first)"},
      {"unheard_bytes", count.unheard_bytes, "bytes that came after a reset, lost (3.5)"},
      {"resets", count.resets, "resets"},
  };
}

const DeviceCounters& Device::counters() const {
  return impl_->counters();
}

std::uint8_t Device::id() const {
  return impl_->id();
}

}  // namespace sonard::ping360
