// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/device.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"
#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/flash_store.hpp"
#include "protocol/gemini/messages.hpp"
#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/pinger.hpp"

namespace sonard::gemini {

namespace {

constexpr std::size_t identity_bank = 0;
constexpr std::size_t address_bank = 2;
constexpr std::uint16_t flash_failed = 0x8004;  // ready; abort code 4, program timeout

void require(bool condition, const char* what) {
  if (!condition) {
    throw std::invalid_argument(std::string("gemini device: ") + what);
  }
}

const DeviceConfig& validated(const DeviceConfig& config) {
  using std::chrono::nanoseconds;
  require(config.sonar_id >= min_sonar_id, "sonar_id must be at least 2");
  require(config.alternate_address != 0, "alternate_address must not be 0.0.0.0");
  require(config.water_sound_speed_mps >= 0.0, "water_sound_speed_mps must not be negative");
  require(config.gain.reference_spreading > 0.0, "gain.reference_spreading must be positive");
  require(config.status_period > nanoseconds{0}, "status_period must be positive");
  require(config.min_ping_period > nanoseconds{0}, "min_ping_period must be positive");
  require(config.client_timeout > nanoseconds{0}, "client_timeout must be positive");
  require(config.reboot_time >= nanoseconds{0}, "reboot_time must not be negative");
  require(config.line_period > nanoseconds{0}, "line_period must be positive");
  require(config.burst_lines >= 1 && config.burst_lines <= 1024, "burst_lines must be 1..1024");
  require(config.retry_hold >= nanoseconds{0}, "retry_hold must not be negative");
  require(config.retry_hold_max >= nanoseconds{0}, "retry_hold_max must not be negative");
  require(config.render_lead >= nanoseconds{0}, "render_lead must not be negative");
  return config;
}

/// True if `mask` is ones followed by zeros.
bool is_netmask(std::uint32_t mask) {
  return mask != 0 && std::has_single_bit(~mask + 1ULL);
}

/// The two u32 with which every info block begins (3.7).
std::array<std::uint32_t, 2> words_of(const IdentityBlock& block) {
  return {block.sonar_id, block.transducer};
}
std::array<std::uint32_t, 2> words_of(const VelocimeterBlock& block) {
  return {block.m_coefficient, static_cast<std::uint32_t>(block.c_coefficient)};
}
std::array<std::uint32_t, 2> words_of(const AddressBlock& block) {
  return {block.alternate_ip, block.subnet_mask};
}

template <class Block>
std::vector<std::uint8_t> block_bytes(const Block& block) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  for (const std::uint32_t word : words_of(block)) {
    writer.u32le(word);
  }
  return bytes;
}

/// True if a command only reads, so that any client may send it (docs/security.md).
bool only_reads(const Command& command) {
  return std::holds_alternative<StatusRequest>(command) || std::holds_alternative<FlashRead>(command) ||
         std::holds_alternative<InfoBlockRead>(command) ||
         std::holds_alternative<TestResultRequest>(command) || std::holds_alternative<GpioRead>(command) ||
         std::holds_alternative<DiagnosticRequest>(command) || std::holds_alternative<RetryRequest>(command);
}

/// Status of a healthy head in cool water, with only the values that clients show (3.3).
Status healthy_status() {
  Status status;
  status.die_temperature = die_temperature_code(45.0);
  status.vga1a_temperature = temperature_code(21.25);
  status.vga1b_temperature = temperature_code(21.5);
  status.vga2a_temperature = temperature_code(22.0);
  status.vga2b_temperature = temperature_code(21.75);
  status.psu2_temperature = temperature_code(30.0);  // PSU 1 has no sensor
  status.tx1_temperature = temperature_code(24.0);
  status.tx2_temperature = temperature_code(24.25);
  status.tx3_temperature = temperature_code(24.5);
  status.die_shutdown_temperature = die_temperature_code(85.0);
  status.psu2_shutdown_temperature = temperature_code(70.0);
  for (std::uint16_t* limit : {&status.vga1a_shutdown_temperature, &status.vga1b_shutdown_temperature,
                               &status.vga2a_shutdown_temperature, &status.vga2b_shutdown_temperature,
                               &status.tx1_shutdown_temperature, &status.tx2_shutdown_temperature,
                               &status.tx3_shutdown_temperature}) {
    *limit = temperature_code(60.0);
  }
  return status;
}

}  // namespace

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint boot_time)
      : config_(validated(config)),
        boot_time_(boot_time),
        next_status_(boot_time),
        addresses_{config.fixed_address, config.alternate_address, config.netmask},
        pinger_(config_, counters_, boot_time) {
    write_block(IdentityBlock{config.sonar_id, 1}, identity_bank);
    write_block(AddressBlock{config.alternate_address, config.netmask}, address_bank);
  }

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& datagram);
  void take(TimePoint, const ClientCame&) {}
  void take(TimePoint, const ClientGone&) {}  // unused: the client is the sender of the last command
  void take(TimePoint now, const PingRendered& ping) { pinger_.on_image(now, ping.image); }
  void take(TimePoint now, const PingNotRendered& ping) { pinger_.on_image_failed(now, ping.number); }
  void take(TimePoint now, const TriggerEdge&);
  void take(TimePoint, const WaterChanged& water);
  void take(TimePoint, const SensorsRead&) {}  // the head has no such sensors
  void take(TimePoint, const PingFed& feed) { pinger_.feed(feed.ping); }
  void take(TimePoint, const NextPingDue&) { pinger_.next_ping_due(); }

  void advance(TimePoint now);
  Actions actions();
  std::uint64_t clock_us(TimePoint now) const;

  const DeviceCounters& counters() const { return counters_; }
  std::string wrong_id_warning() const {
    return "{} commands were for another sonar ID: the last one for " + std::to_string(last_wrong_id_) +
           ", but this head has " + std::to_string(config_.sonar_id) + " (sonar_id)";
  }
  Ipv4 client() const { return client_; }
  DeviceAddresses addresses() const { return addresses_; }
  void move_to(Ipv4 alternate, Ipv4 netmask) {
    addresses_.alternate = alternate;
    addresses_.netmask = netmask;
    write_block(AddressBlock{alternate, netmask}, address_bank);
  }

 private:
  /// While the head reboots it ignores everything that arrives.
  bool rebooting(TimePoint now) const { return now < boot_time_; }
  std::optional<TimePoint> next_deadline() const;
  bool locked_against(Ipv4 sender) const;
  Ipv4 holder() const;
  void connect(TimePoint now);
  void notice_client();
  void check_client(TimePoint now);
  void send_status(TimePoint now);
  Status make_status(TimePoint now) const;

  // One overload for each command.
  void handle(TimePoint now, const StatusRequest& command);
  void handle(TimePoint now, const PingConfig& command);
  void handle(TimePoint now, const FlashWrite& command);
  void handle(TimePoint now, const FlashRead& command);
  void handle(TimePoint now, const InfoBlockWrite& command);
  void handle(TimePoint now, const InfoBlockRead& command);
  void handle(TimePoint now, const Reboot& command);
  void handle(TimePoint, const TestResultRequest&) { reply(TestResult{}); }
  void handle(TimePoint now, const RetryRequest& command);
  void handle(TimePoint now, const NetworkConfig& command);
  void handle(TimePoint, const MdioCommands&) { reply(MdioAcknowledge{}); }
  void handle(TimePoint, const TxDriveTest&) { reply(GpiData{}); }
  void handle(TimePoint, const GpoWrite&) { reply(GpiData{}); }
  void handle(TimePoint, const GpioRead&) { reply(GpiData{}); }
  void handle(TimePoint, const DiagnosticRequest&) { reply(Diagnostic{}); }
  void handle(TimePoint, const GoingOffline&) { pinger_.stop(); }
  void handle(TimePoint, const SerialTransmit&) {}  // nothing is fitted to the serial port
  void handle(TimePoint, const ProductionTest&) {}
  void handle(TimePoint, const PowerOnSelfTest&) {}
  void handle(TimePoint, const AbortProductionTest&) {}
  void handle(TimePoint, const Unknown&) {}  // never called: take() drops unknown commands

  template <class Block>
  void write_block(const Block& block, std::size_t bank) {
    flash_.write_page(info_block_addresses.at(bank), block_bytes(block));
  }
  void apply_programmed_addresses();

  template <class Message>
  void reply(Message message) {
    message.header.sonar_id = config_.sonar_id;
    actions_.send.push_back({Outgoing::To::peer,
                             {0, {asker_.remote.address, config_.client_port}, asker_.local},
                             SharedBytes(encode(Report{message}))});
  }
  void send_to_client(SharedBytes bytes) {
    actions_.send.push_back(
        {Outgoing::To::peer, {0, {client_, config_.client_port}, reply_from_}, std::move(bytes)});
  }
  void reply_with_flash(std::uint32_t address) {
    FlashReadback readback;
    readback.address = address;
    readback.data = flash_.read(address);
    reply(readback);
  }

  const DeviceConfig config_;
  DeviceCounters counters_;
  TimePoint boot_time_;  ///< in the future while the head reboots
  TimePoint next_status_;
  DeviceAddresses addresses_;
  bool out_of_water_ = false;

  Ipv4 client_ = 0;
  Ipv4 noticed_client_ = 0;  ///< client_ at the last notice
  Ipv4 paused_for_ = 0;      ///< client whose programme is paused, while Pinger::paused()
  Ipv4 reply_from_ = 0;      ///< source address of pings
  Peer asker_;               ///< sender of the command in progress
  TimePoint last_command_{};
  std::uint16_t last_wrong_id_ = 0;  ///< of the newest command for another head

  FlashStore flash_;
  PingConfigWarnings warnings_;
  Pinger pinger_;
  std::vector<SharedBytes> ping_datagrams_;  ///< scratch of advance()
  Actions actions_;                          ///< of the step in progress
};

// ---- Commands
// ---------------------------------------------------------------------------------------------------

void Device::Impl::take(TimePoint now, const BytesReceived& datagram) {
  if (rebooting(now)) {
    return;
  }
  check_client(now);
  const std::span<const std::uint8_t> bytes(datagram.bytes.data(), datagram.bytes.size());
  const auto header = decode_header(bytes);
  if (!header || datagram.from.remote.address == 0) {
    ++counters_.bad_datagrams;
    return;
  }
  if (header->sonar_id != config_.sonar_id && !(header->sonar_id == 0 && config_.accept_id_zero)) {
    ++counters_.wrong_id;
    last_wrong_id_ = header->sonar_id;
    actions_.misaddressed = "A client sends commands for sonar ID " + std::to_string(last_wrong_id_) +
                            ", but this head has sonar ID " + std::to_string(config_.sonar_id) +
                            ". Set sonar_id to the ID of the client's sonar.";
    return;
  }
  const auto command = decode_command(bytes);
  if (!command) {
    ++counters_.bad_datagrams;
    return;
  }
  if (std::holds_alternative<Unknown>(*command)) {
    ++counters_.unknown_type;  // dropped; it does not count as a sign of a client either
    return;
  }
  if (locked_against(datagram.from.remote.address)) {
    ++counters_.locked_out;
    return;
  }
  ++counters_.commands;
  asker_ = datagram.from;
  const bool of_another = holder() != 0 && holder() != asker_.remote.address;
  if (!of_another || !only_reads(*command)) {
    connect(now);
  }
  std::visit([&](const auto& message) { handle(now, message); }, *command);
}

void Device::Impl::take(TimePoint now, const TriggerEdge&) {
  if (!rebooting(now)) {
    pinger_.on_trigger(now);
  }
}

void Device::Impl::take(TimePoint, const WaterChanged& water) {
  out_of_water_ = water.out_of_water;
  pinger_.set_out_of_water(water.out_of_water);
}

bool Device::Impl::locked_against(Ipv4 sender) const {
  return config_.lock_to_first && client_ != 0 && client_ != sender;
}

/// The client that receives pings, or whose programme is paused; 0: there is no such client.
Ipv4 Device::Impl::holder() const {
  return client_ == 0 && pinger_.paused() ? paused_for_ : client_;
}

void Device::Impl::connect(TimePoint now) {
  const Ipv4 sender = asker_.remote.address;
  if (client_ != 0 && client_ != sender) {
    ++counters_.client_changes;  // the newest wins and receives the rest of the ping on the wire
  }
  client_ = sender;
  reply_from_ = asker_.local;
  last_command_ = now;
  if (!pinger_.paused() || paused_for_ == sender) {
    pinger_.resume(now);
  }
  notice_client();
}

void Device::Impl::handle(TimePoint now, const StatusRequest&) {
  Acknowledge acknowledge;
  acknowledge.receipt_us = clock_us(now);
  acknowledge.reply_us = acknowledge.receipt_us;  // sent in the same step
  reply(acknowledge);
}

void Device::Impl::handle(TimePoint now, const PingConfig& command) {
  if (!config_.plays_back) {
    counters_.out_of_range += warnings_.check(command, actions_.notices) ? 1 : 0;
  }
  pinger_.resume(now);  // this configuration replaces a paused programme of another client
  pinger_.configure(now, command);
}

/// Only the client may request repeats, because only it received the last ping.
void Device::Impl::handle(TimePoint now, const RetryRequest& command) {
  if (asker_.remote.address == client_) {
    pinger_.on_retry(now, command);
  } else {
    ++counters_.retries_received;
    ++counters_.retries_dropped;
  }
}

void Device::Impl::handle(TimePoint, const NetworkConfig& command) {
  pinger_.set_inter_packet_gap(std::chrono::nanoseconds{8} * command.inter_packet_gap);
}

void Device::Impl::handle(TimePoint, const FlashWrite& command) {
  FlashResult result;
  result.address = command.address;
  if (!flash_.write_page(command.address, command.data)) {
    result.result = flash_failed;
  }
  reply(result);
  if (command.read_back()) {
    reply_with_flash(command.address);
  }
}

void Device::Impl::handle(TimePoint, const FlashRead& command) {
  constexpr std::uint32_t word_mask = ~3U;
  reply_with_flash(command.address & word_mask);
}

void Device::Impl::handle(TimePoint, const InfoBlockWrite& command) {
  // Identity and velocimeter blocks are for production: they are stored and can be read, but have no effect.
  const std::size_t bank = command.block.index();
  std::visit([&](const auto& block) { write_block(block, bank); }, command.block);
  FlashResult result;
  result.address = info_block_addresses.at(bank);
  reply(result);
}

void Device::Impl::handle(TimePoint, const InfoBlockRead& command) {
  if (command.bank < info_block_addresses.size()) {
    reply_with_flash(info_block_addresses.at(command.bank));
  }
}

void Device::Impl::handle(TimePoint now, const Reboot& command) {
  // All other values address the boot loader, which this head does not run.
  constexpr std::uint8_t into_main_image = 1;
  if (command.control != into_main_image) {
    return;
  }
  ++counters_.reboots;
  boot_time_ = now + config_.reboot_time;
  next_status_ = boot_time_;
  client_ = 0;
  reply_from_ = 0;
  pinger_.reset(boot_time_);
  apply_programmed_addresses();
}

// If the page holds no usable address (erased, cleared, a mask with holes), the head keeps its addresses so
// that clients can reach it.
void Device::Impl::apply_programmed_addresses() {
  const FlashStore::Page page = flash_.read(info_block_addresses.at(address_bank));
  ByteReader reader(page);
  const Ipv4 alternate = reader.u32le("alternate_ip");
  const Ipv4 netmask = reader.u32le("subnet_mask");
  if (alternate != 0 && alternate != 0xFFFFFFFF && is_netmask(netmask)) {
    addresses_.alternate = alternate;
    addresses_.netmask = netmask;
  }
}

// ---- Time
// -------------------------------------------------------------------------------------------------------

std::uint64_t Device::Impl::clock_us(TimePoint now) const {
  return now < boot_time_ ? 0 : static_cast<std::uint64_t>((now - boot_time_) / std::chrono::microseconds{1});
}

void Device::Impl::check_client(TimePoint now) {
  if (client_ != 0 && now - last_command_ >= config_.client_timeout) {
    ++counters_.client_timeouts;
    if (!pinger_.paused()) {
      paused_for_ = client_;
    }
    client_ = 0;
    reply_from_ = 0;
    pinger_.suspend();
  }
}

void Device::Impl::send_status(TimePoint now) {
  if (now < next_status_) {
    return;
  }
  actions_.send.push_back({Outgoing::To::everybody, {}, SharedBytes(encode(Report{make_status(now)}))});
  // Keeps the phase; statuses that a late caller missed are skipped.
  next_status_ += config_.status_period * ((now - next_status_) / config_.status_period + 1);
}

Status Device::Impl::make_status(TimePoint now) const {
  Status status = healthy_status();
  status.header.sonar_id = config_.sonar_id;
  status.sonar_id = config_.sonar_id;
  status.fixed_ip = addresses_.fixed;
  status.alternate_ip = addresses_.alternate;
  status.subnet_mask = addresses_.netmask;
  status.surface_ip = client_;
  status.mac.octets = config_.mac;
  status.clock_us = clock_us(now);
  if (out_of_water_) {
    status.shutdown_status |= shutdown_bits::out_of_water;
  }
  if (pinger_.stopped_by_air()) {
    status.shutdown_status |= shutdown_bits::out_of_water_stop;
  }
  return status;
}

void Device::Impl::advance(TimePoint now) {
  if (rebooting(now)) {
    return;
  }
  check_client(now);
  send_status(now);
  ping_datagrams_.clear();
  pinger_.advance(now, ping_datagrams_);
  for (SharedBytes& bytes : ping_datagrams_) {
    send_to_client(std::move(bytes));
  }
}

Actions Device::Impl::actions() {
  notice_client();
  Actions actions = std::exchange(actions_, {});
  pinger_.report(actions);
  actions.nobody_there = client_ == 0;
  actions.wake_at = next_deadline();
  return actions;
}

void Device::Impl::notice_client() {
  if (noticed_client_ == client_) {
    return;
  }
  actions_.notices.push_back(
      {Notice::Level::info, client_ != 0 ? "client " + address_text(client_) + " connected"
                                         : "client " + address_text(noticed_client_) +
                                               " lost: no command within the time-out, or a reboot command"});
  noticed_client_ = client_;
}

std::optional<TimePoint> Device::Impl::next_deadline() const {
  TimePoint next = next_status_;
  if (client_ != 0) {
    next = std::min(next, last_command_ + config_.client_timeout);
  }
  return std::min(next, pinger_.next_deadline().value_or(next));
}

// ---- Device
// ---------------------------------------------------------------------------------------------------

Device::Device(const DeviceConfig& config, TimePoint boot_time)
    : impl_(std::make_unique<Impl>(config, boot_time)) {}
Device::~Device() = default;

Actions Device::step(TimePoint now, const Event& event) {
  std::visit([&](const auto& what) { impl_->take(now, what); }, event);
  impl_->advance(now);
  return impl_->actions();
}

PingProgress Device::progress() const {
  const DeviceCounters& count = counters();
  return {.sent = count.pings_sent,
          .ended = count.pings_ended(),
          .messages = count.lines_sent + count.lines_resent + count.tails_resent + count.heads_resent +
                      count.retries_received};
}

std::vector<Counter> Device::counts() const {
  using Fault = Counter::Fault;
  using Shown = Counter::Shown;
  const DeviceCounters& count = counters();
  return {
      {"pings_sent", count.pings_sent, "pings sent to the end of their tail"},
      {"pings_failed", count.pings_failed, "pings that could not be rendered"},
      {"pings_suppressed", count.pings_suppressed,
       "pings not made: out of the water, or a trigger edge during a ping", Fault::none, Shown::warns,
       "{} pings not made: out of the water"},
      {"lines_sent", count.lines_sent, "lines, without repetitions"},
      {"lines_resent", count.lines_resent, "lines that a client requested again", Fault::none, Shown::often},
      {"tails_resent", count.tails_resent, "tails that a client requested again", Fault::none, Shown::often},
      {"heads_resent", count.heads_resent, "ping heads that a client requested again"},
      {"retries_dropped", count.retries_dropped,
       "requests to repeat lines that the head no longer has, or of another client"},
      {"commands", count.commands, "commands that the head accepted"},
      {"wrong_id", count.wrong_id, "commands with the ID of another sonar, ignored (1.4)", Fault::of_client,
       Shown::warns, impl_->wrong_id_warning()},
      {"bad_datagrams", count.bad_datagrams, "datagrams that are too short or have invalid contents, ignored",
       Fault::of_client, Shown::warns, "{} datagrams were not Gemini 720i commands"},
      {"unknown_type", count.unknown_type, "messages of unknown type, ignored (3.1)", Fault::of_client,
       Shown::warns, "{} messages had an unknown type: the head ignores them"},
      {"out_of_range", count.out_of_range,
       "ping configurations with `end_range` or `sound_speed` out of range, clamped (5)", Fault::of_client,
       Shown::once},
      {"unsupported_data", count.unsupported_data,
       "ping configurations for I/Q or channel data, which sonard does not have, or run mode 3: no ping",
       Fault::none, Shown::warns,
       "{} ping configurations requested unsupported data (I/Q, channels) or run mode 3"},
      {"locked_out", count.locked_out, "commands of other clients, dropped (`lock_to_first`)", Fault::none,
       Shown::warns, "{} commands were dropped: another client uses the head (lock_to_first)"},
      {"client_changes", count.client_changes, "times that another client took the head (1.5)"},
      {"client_timeouts", count.client_timeouts,
       "times that a client was silent for 3 s: the pings stop (1.5)"},
      {"reboots", count.reboots, "reboot commands"}};
}

const DeviceCounters& Device::counters() const {
  return impl_->counters();
}
Ipv4 Device::client() const {
  return impl_->client();
}
DeviceAddresses Device::addresses() const {
  return impl_->addresses();
}
void Device::move_to(Ipv4 alternate, Ipv4 netmask) {
  impl_->move_to(alternate, netmask);
}
std::uint64_t Device::clock_us(TimePoint now) const {
  return impl_->clock_us(now);
}

}  // namespace sonard::gemini
