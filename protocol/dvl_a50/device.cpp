// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/device.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <deque>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "protocol/common/endpoint.hpp"
#include "protocol/common/once_warnings.hpp"
#include "protocol/common/ping_cycle.hpp"
#include "protocol/dvl_a50/codec.hpp"
#include "protocol/dvl_a50/dead_reckoning.hpp"
#include "protocol/dvl_a50/http.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "protocol/dvl_a50/pathfinder.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "protocol/dvl_a50/sentences.hpp"
#include "protocol/dvl_a50/utc.hpp"

namespace sonard::dvl_a50 {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr milliseconds position_period{200};
constexpr milliseconds position_after_reset{50};
constexpr milliseconds serial_patience{10};  ///< between the characters of a command (6)
constexpr nanoseconds least_period{milliseconds{1}};
constexpr std::size_t most_line_bytes = 256;
constexpr std::size_t most_delayed = 32;
constexpr int most_triggers = 15;
constexpr double longest_force_sync_s = 60.0;

const DeviceConfig& validated(const DeviceConfig& config) {
  const auto require = [](bool condition, const char* what) {
    if (!condition) {
      throw std::invalid_argument(std::string("dvl_a50 device: ") + what);
    }
  };
  require(!wrong_setting(config.settings, config.release), "settings are out of range");
  require(config.water_sound_speed_mps > 0.0, "water_sound_speed_mps must be positive");
  require(config.most_speed_mps > 0.0, "most_speed_mps must be positive");
  require(config.most_water_speed_mps > 0.0, "most_water_speed_mps must be positive");
  require(config.beam_noise_mps >= 0.0, "beam_noise_mps must not be negative");
  require(config.beam_noise_factor >= 0.0, "beam_noise_factor must not be negative");
  require(config.distance_steps_hz > 0.0, "distance_steps_hz must be positive");
  require(config.position_noise_m >= 0.0, "position_noise_m must not be negative");
  require(config.water_rate_hz > 0.0, "water_rate_hz must be positive");
  for (const RangeMode& mode : config.range_modes) {
    require(mode.least_m >= 0.0 && mode.most_m > mode.least_m && mode.rate_hz > 0.0,
            "range_modes must have limits that rise and a rate");
  }
  require(config.time_scale >= 0.0 && config.time_scale <= 1000.0, "time_scale must be 0..1000");
  require(config.search_interval > nanoseconds{0}, "search_interval must be positive");
  require(config.cycling_interval > nanoseconds{0}, "cycling_interval must be positive");
  require(config.processing_delay >= nanoseconds{0}, "processing_delay must not be negative");
  require(config.calibration_time >= nanoseconds{0}, "calibration_time must not be negative");
  return config;
}

std::int64_t microseconds_of(nanoseconds time) {
  return std::chrono::floor<std::chrono::microseconds>(time).count();
}

nanoseconds travel_time(double way_m, double speed_mps) {
  return nanoseconds{std::llround(1e9 * std::clamp(way_m / speed_mps, 0.0, 100.0))};
}

SharedBytes bytes_of(std::string_view text) {
  return SharedBytes(std::vector<std::uint8_t>(text.begin(), text.end()));
}

bool same_client(const Peer& a, const Peer& b) {
  return a.channel == b.channel && a.remote == b.remote;
}

}  // namespace

class Device::Impl {
 public:
  Impl(const DeviceConfig& config, TimePoint start)
      : config_(validated(config)),
        settings_(config.settings),
        serial_output_(config.serial_output),
        noise_(config.seed),
        dead_reckoning_(
            {config.heading_drift_deg_per_min * std::numbers::pi / 180.0 / 60.0, config.position_noise_m},
            config.seed + 1),
        cycle_({.simulated_time = config.simulated_time, .plays_back = config.plays_back}, start, counters_),
        start_(start),
        position_due_(start + position_period),
        next_cycling_(start + config.cycling_interval) {}

  // One overload for each event.
  void take(TimePoint, const TimePassed&) {}
  void take(TimePoint now, const BytesReceived& piece);
  void take(TimePoint, const ClientCame& came) { client_of(came.who); }
  void take(TimePoint, const ClientGone& gone) { forget(gone.who); }
  void take(TimePoint now, const PingRendered& ping);
  void take(TimePoint now, const PingNotRendered& ping) { cycle_.on_image_failed(now, ping.number); }
  void take(TimePoint, const TriggerEdge&) {}   // the device has no trigger input
  void take(TimePoint, const WaterChanged&) {}  // in air there are no echoes
  void take(TimePoint now, const SensorsRead& sensors);
  void take(TimePoint, const PingFed& feed) {
    cycle_.feed(feed.ping && recorded_form(feed.ping->wire) ? feed.ping : std::nullopt);
  }
  void take(TimePoint, const NextPingDue&) { cycle_.grant(); }

  void advance(TimePoint now);
  Actions actions(TimePoint now);

  const DeviceCounters& counters() const { return counters_; }
  std::vector<Counter> counts() const;

 private:
  struct Client {
    Peer peer;
    JsonStream stream;    ///< of a JSON client
    std::string request;  ///< of an HTTP client
  };
  struct Delayed {
    TimePoint due{};
    Peer peer;
    SharedBytes bytes;
  };
  struct Pending {
    TimePoint due{};
    Velocity report;
  };
  /// The ping under way.
  struct Ping {
    PingPlan plan;
    bool triggered = false;
    std::optional<Velocity> recorded;
    Velocity report;                    ///< set at the arrival of the image
    std::vector<std::uint8_t> samples;  ///< of a recorded ping, as they came
  };
  /// What a command did.
  struct Outcome {
    std::string error;            ///< empty: success
    std::string result = "null";  ///< JSON
    nanoseconds delay{0};         ///< of the answer
  };
  struct Command {
    std::string_view name;
    Release since;
    Outcome (Impl::*run)(TimePoint now, const Json::Members& parameters);
  };

  // Clients.
  Client& client_of(const Peer& peer);
  void forget(const Peer& peer);
  bool heard() const;
  void send(const Peer& peer, SharedBytes bytes) {
    outgoing_.push_back({Outgoing::To::peer, peer, std::move(bytes)});
  }
  void send_to_channel(int channel, const SharedBytes& bytes);
  void send_json(std::string text) { send_to_channel(json_channel, bytes_of(text + config_.line_end)); }
  void send_serial(std::string_view text) { send(serial_peer(), bytes_of(fmt::format("{}\r\n", text))); }
  void answer(TimePoint now, const Peer& peer, std::string_view text, nanoseconds delay);
  Peer serial_peer() const { return {config_.serial_channel, {}, 0}; }
  std::string_view format() const { return texts_of(config_.release).format; }
  std::int64_t unix_us(TimePoint time) const {
    return microseconds_of(time + config_.unix_offset + clock_offset_);
  }

  // Input.
  void take_json(TimePoint now, Client& client, const SharedBytes& bytes);
  void take_object(TimePoint now, const Peer& peer, const std::string& text);
  void take_serial(TimePoint now, const SharedBytes& bytes);
  void take_line(TimePoint now, const std::string& line);
  void run_serial(TimePoint now, const SerialCommand& command);
  void take_http(Client& client, const SharedBytes& bytes);
  void refuse(std::string_view subject, std::string text);

  // Commands.
  static const std::vector<Command>& commands();
  Outcome reset(TimePoint now, const Json::Members&);
  Outcome calibrate(TimePoint, const Json::Members&);
  Outcome trigger(TimePoint, const Json::Members&);
  Outcome get_config(TimePoint, const Json::Members&);
  Outcome set_config(TimePoint, const Json::Members& parameters);
  Outcome get_version(TimePoint, const Json::Members&) { return {{}, version_text()}; }
  Outcome set_ntp(TimePoint, const Json::Members& parameters);
  Outcome get_ntp(TimePoint, const Json::Members&);
  Outcome set_time(TimePoint now, const Json::Members& parameters);
  Outcome get_time(TimePoint now, const Json::Members&) { return {{}, time_status_text(now)}; }
  Outcome force_sync(TimePoint now, const Json::Members& parameters);
  void use(const Settings& settings);
  std::string version_text() const;
  std::string time_status_text(TimePoint now) const;
  std::int64_t seconds_since_sync(TimePoint now) const { return (now - start_) / seconds{1} % 64; }

  // Pings and reports.
  bool pinging() const { return heard() && (settings_.acoustic_enabled || triggers_ > 0); }
  PingPlan plan() const { return plan_ping(mode_, config_, settings_); }
  nanoseconds period(const PingPlan& plan) const {
    return std::max(ping_period(plan, config_), least_period);
  }
  nanoseconds listening_time(const PingPlan& plan) const {
    return travel_time(2.0 * plan.range_m, config_.water_sound_speed_mps);
  }
  std::optional<TimePoint> next_start() const;
  std::optional<TimePoint> image_due() const;
  void begin_ping(TimePoint now);
  void finish_ping(TimePoint now);
  void report(TimePoint now, Velocity velocity);
  void report_position(TimePoint now);
  void move(TimePoint now);

  const DeviceConfig config_;
  DeviceCounters counters_;
  Settings settings_;
  int serial_output_;
  std::vector<Client> clients_;
  std::string line_;                     ///< of the serial line, unfinished
  std::optional<TimePoint> line_until_;  ///< the patience with it
  std::vector<Delayed> delayed_;
  std::string ntp_address_ = "auto";
  nanoseconds clock_offset_{0};  ///< by set_time_manual

  Noise noise_;
  DeadReckoning dead_reckoning_;
  std::optional<SensorReadings> readings_;
  std::optional<int> mode_;  ///< with bottom lock
  bool locked_ = false;
  int triggers_ = 0;
  PingCycle cycle_;
  Ping ping_;
  std::deque<Pending> pending_;
  const TimePoint start_;
  TimePoint position_due_, next_cycling_;
  TimePoint next_ping_{};  ///< by the rate
  TimePoint wanted_{};     ///< since when pings are wanted
  TimePoint last_start_{};
  std::optional<TimePoint> reported_at_;
  bool was_pinging_ = false;

  // Of the step in progress.
  std::vector<Outgoing> outgoing_;
  std::vector<Peer> disconnect_;
  std::vector<Notice> notices_;
  OnceWarnings warnings_;
};

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

// ---- Input

void Device::Impl::take(TimePoint now, const BytesReceived& piece) {
  const int channel = piece.from.channel;
  if (channel == json_channel) {
    take_json(now, client_of(piece.from), piece.bytes);
  } else if (channel == config_.http_channel) {
    take_http(client_of(piece.from), piece.bytes);
  } else if (channel == config_.serial_channel) {
    take_serial(now, piece.bytes);
  }  // PD6 and PD4 take no commands
}

void Device::Impl::take_json(TimePoint now, Client& client, const SharedBytes& bytes) {
  const std::uint64_t dropped = client.stream.dropped();
  client.stream.append({bytes.data(), bytes.size()});
  while (const std::optional<std::string> object = client.stream.next()) {
    take_object(now, client.peer, *object);
  }
  counters_.dropped_bytes += client.stream.dropped() - dropped;
  if (client.stream.overflowed()) {
    ++counters_.overflows;
    client.stream = {};
    disconnect_.push_back(client.peer);
  }
}

/// @param subject a literal
void Device::Impl::refuse(std::string_view subject, std::string text) {
  ++counters_.refused;
  warnings_.warn(subject, std::move(text), notices_);
}

const std::vector<Device::Impl::Command>& Device::Impl::commands() {
  static const std::vector<Command> all{{"reset_dead_reckoning", Release::v2_1_0, &Impl::reset},
                                        {"calibrate_gyro", Release::v2_2_1, &Impl::calibrate},
                                        {"trigger_ping", Release::v2_4_0, &Impl::trigger},
                                        {"get_config", Release::v2_1_0, &Impl::get_config},
                                        {"set_config", Release::v2_1_0, &Impl::set_config},
                                        {"get_version_info", Release::v2_7_2, &Impl::get_version},
                                        {"set_time_ntp", Release::v2_7_2, &Impl::set_ntp},
                                        {"get_time_ntp", Release::v2_7_2, &Impl::get_ntp},
                                        {"set_time_manual", Release::v2_7_2, &Impl::set_time},
                                        {"get_time_status", Release::v2_7_2, &Impl::get_time},
                                        {"force_sync_ntp", Release::v2_7_2, &Impl::force_sync}};
  return all;
}

void Device::Impl::take_object(TimePoint now, const Peer& peer, const std::string& text) {
  const std::optional<Json> object = parse_json(text);
  const Json* const named = object ? object->find("command") : nullptr;
  const auto* const name = named != nullptr ? named->as<std::string>() : nullptr;
  if (name == nullptr) {
    ++counters_.unreadable;
    warnings_.warn("no command", "a client sent an object that is no command; it is ignored", notices_);
    return;
  }
  const Json* const given = object->find("parameters");
  const auto* const parameters = given != nullptr ? given->as<Json::Members>() : nullptr;
  const auto known = std::ranges::find_if(
      commands(), [&](const Command& it) { return it.name == *name && it.since <= config_.release; });
  Outcome outcome{"unknown command"};
  if (known != commands().end()) {
    ++counters_.commands;
    outcome = (this->*known->run)(now, parameters != nullptr ? *parameters : Json::Members{});
  }
  if (!outcome.error.empty()) {
    refuse("json", fmt::format("the command {} of a client failed: {}", json_text(*name), outcome.error));
  }
  answer(now, peer, encode(Response{outcome.error, outcome.result}, *name, format()) + config_.line_end,
         outcome.delay);
}

void Device::Impl::take_http(Client& client, const SharedBytes& bytes) {
  client.request.append(bytes.begin(), bytes.end());
  const std::optional<std::string> path = requested_path(client.request);
  const bool too_long = client.request.size() > most_request_bytes;
  if (!path && !too_long) {
    return;
  }
  client.request.clear();
  ++counters_.http_requests;
  std::string response;
  if (too_long || path->empty()) {
    response = http_response("400 Bad Request", "text/plain", "only GET\n");
  } else if (*path == "/api/v1/about") {
    response = http_response("200 OK", "application/json", version_text());
  } else if (*path == "/api/v1/about/status") {
    response = http_response("200 OK", "application/json",
                             fmt::format(R"({{"temperature":{}}})", json_number(config_.temperature_c)));
  } else if (*path == "/") {
    response = http_response("200 OK", "text/plain", config_.product_name + "\n");
  } else {
    response = http_response("404 Not Found", "text/plain", "not found\n");
  }
  send(client.peer, bytes_of(response));
  disconnect_.push_back(client.peer);
}

// ---- Serial line

void Device::Impl::take_serial(TimePoint now, const SharedBytes& bytes) {
  for (const std::uint8_t byte : bytes) {
    const auto c = static_cast<char>(byte);
    if (c != '\r' && c != '\n') {
      line_ += c;
    }
    if (line_.size() > most_line_bytes || (c == '\r' || c == '\n')) {
      if (const std::string line = std::exchange(line_, {}); !line.empty()) {
        take_line(now, line);
      }
    }
  }
  line_until_ = line_.empty() ? std::nullopt : std::optional(now + serial_patience);
}

void Device::Impl::take_line(TimePoint now, const std::string& line) {
  const std::optional<SerialCommand> command = parse_command(line);
  if (command && command->checked) {
    run_serial(now, *command);
    return;
  }
  ++(command ? counters_.bad_checksums : counters_.unreadable);
  send_serial(with_checksum(command ? "wr!" : "wr?"));
}

void Device::Impl::run_serial(TimePoint now, const SerialCommand& command) {
  const auto& [name, options, checked] = command;
  const auto is = [&](std::string_view wanted, std::size_t count) {
    return command.name == wanted && command.options.size() == count;
  };
  const auto finish = [&](const Outcome& outcome) {
    ++counters_.commands;
    if (!outcome.error.empty()) {
      refuse("serial",
             fmt::format("the serial command {} failed: {}", json_text(command.name), outcome.error));
    }
    const std::string text = with_checksum(outcome.error.empty() ? "wra" : "wrn") + "\r\n";
    answer(now, serial_peer(), text, outcome.delay);
  };
  const auto tell = [&](const std::string& text) {
    ++counters_.commands;
    send_serial(with_checksum(text));
  };
  const auto text_of = [](const std::string& text) { return Json::Members{{"ntp_address", Json{text}}}; };
  Settings wanted = settings_;
  if (is("wcv", 0)) {
    tell(fmt::format("wrv,{}", texts_of(config_.release).serial));
  } else if (is("wcw", 0)) {
    tell(
        fmt::format("wrw,{},{},{}", config_.serial_name, texts_of(config_.release).version, config_.chip_id));
  } else if (is("wcc", 0)) {
    ++counters_.commands;
    send_serial(settings_sentence(settings_));
  } else if (is("wcr", 0)) {
    finish(reset(now, {}));
  } else if (is("wcg", 0)) {
    finish(calibrate(now, {}));
  } else if (is("wcx", 0)) {
    finish(trigger(now, {}));
  } else if (name == "wcs" && apply(options, wanted)) {
    const auto wrong = wrong_setting(wanted, config_.release);
    if (!wrong) {
      use(wanted);
    }
    finish({wrong ? "invalid value for " + *wrong : ""});
  } else if (is("wcp", 1) && options[0].size() == 1 &&
             std::string_view("01236").find(options[0]) != std::string_view::npos) {
    serial_output_ = options[0][0] - '0';
    finish({});
  } else if (is("wcn", 1)) {
    finish(set_ntp(now, text_of(options[0])));
  } else if (is("wcN", 0)) {
    tell("wrN," + ntp_address_);
  } else if (is("wcm", 1)) {
    std::int64_t wanted_us = 0;
    const std::string& text = options[0];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), wanted_us);
    const bool good = error == std::errc{} && end == text.data() + text.size();
    finish(good ? set_time(
                      now,
                      {{"now", Json{rfc3339(std::clamp<std::int64_t>(wanted_us, 0, 4'000'000'000'000'000))}}})
                : Outcome{"invalid value for now"});
  } else if (is("wcT", 1)) {
    tell(config_.ntp_synced ? "wrT,y" : "wrT,n");
  } else if (is("wct", 0)) {
    tell(config_.ntp_synced
             ? fmt::format("wrs,{},1,{},{}", unix_us(now) / 1'000'000, ntp_address_, seconds_since_sync(now))
             : fmt::format("wrs,{},0,,", unix_us(now) / 1'000'000));
  } else {
    ++counters_.unreadable;
    send_serial(with_checksum("wr?"));
  }
}

// ---- Commands

Device::Impl::Outcome Device::Impl::reset(TimePoint now, const Json::Members&) {
  dead_reckoning_.reset();
  move(now);
  position_due_ = now + position_after_reset;
  return {};
}

Device::Impl::Outcome Device::Impl::calibrate(TimePoint, const Json::Members&) {
  const auto taken = std::chrono::duration<double, std::nano>(config_.calibration_time) * config_.time_scale;
  return {.error = {}, .delay = std::chrono::duration_cast<nanoseconds>(taken)};
}

Device::Impl::Outcome Device::Impl::trigger(TimePoint, const Json::Members&) {
  if (settings_.acoustic_enabled) {
    return {"acoustic_enabled must be false"};
  }
  if (triggers_ == most_triggers) {
    return {"too many queued triggers"};
  }
  ++triggers_;
  return {};
}

Device::Impl::Outcome Device::Impl::get_config(TimePoint, const Json::Members&) {
  return {{}, encode(settings_, config_.release)};
}

Device::Impl::Outcome Device::Impl::set_config(TimePoint, const Json::Members& parameters) {
  Settings wanted = settings_;
  if (const auto wrong = apply(parameters, config_.release, wanted)) {
    return {"invalid value for " + *wrong};
  }
  use(wanted);
  return {};
}

void Device::Impl::use(const Settings& settings) {
  settings_ = settings;
  triggers_ = settings_.acoustic_enabled ? 0 : triggers_;
}

Device::Impl::Outcome Device::Impl::set_ntp(TimePoint, const Json::Members& parameters) {
  const Json all{parameters};
  const Json* const address = all.find("ntp_address");
  const auto* const text = address != nullptr ? address->as<std::string>() : nullptr;
  if (text == nullptr || text->empty() || text->size() > 64) {
    return {"invalid value for ntp_address"};
  }
  ntp_address_ = *text;
  return {};
}

Device::Impl::Outcome Device::Impl::get_ntp(TimePoint, const Json::Members&) {
  return {{}, fmt::format(R"({{"ntp_address":{}}})", json_text(ntp_address_))};
}

Device::Impl::Outcome Device::Impl::set_time(TimePoint now, const Json::Members& parameters) {
  if (config_.ntp_synced) {
    return {"Manual time not allowed when NTP is synchronized"};
  }
  const Json all{parameters};
  const Json* const wanted = all.find("now");
  const auto* const text = wanted != nullptr ? wanted->as<std::string>() : nullptr;
  const auto wanted_us = text != nullptr ? parse_rfc3339(*text) : std::nullopt;
  if (!wanted_us || *wanted_us < 0 || *wanted_us > 4'000'000'000'000'000) {
    return {"invalid value for now"};
  }
  clock_offset_ += std::chrono::microseconds{*wanted_us - unix_us(now)};
  return {};
}

Device::Impl::Outcome Device::Impl::force_sync(TimePoint now, const Json::Members& parameters) {
  const Json all{parameters};
  const Json* const patience = all.find("timeout_seconds");
  const auto* const timeout_s = patience != nullptr ? patience->as<double>() : nullptr;
  if (timeout_s == nullptr || *timeout_s < 0.0) {
    return {"invalid value for timeout_seconds"};
  }
  const bool synced = config_.ntp_synced;
  const double delay_s = synced ? 0.0 : std::min(*timeout_s, longest_force_sync_s);
  return {{},
          fmt::format(R"({{"success":{},"message":"NTP force-sync {}","status":{}}})", synced,
                      synced ? "successful" : "not successful within timeout", time_status_text(now)),
          nanoseconds{std::llround(1e9 * delay_s)}};
}

std::string Device::Impl::version_text() const {
  const std::string_view version = texts_of(config_.release).version;
  return fmt::format(
      R"({{"chipid":{},"hardware_revision":4,"product_id":{},"product_name":{},"variant":"standard",)"
      R"x("version_short":"{}","version":"{} (sonard)","is_ready":true}})x",
      json_text(config_.chip_id), config_.product_id, json_text(config_.product_name), version, version);
}

std::string Device::Impl::time_status_text(TimePoint now) const {
  const bool synced = config_.ntp_synced;
  return fmt::format(
      R"({{"system_time":"{}","ntp_synced":{},"ntp_synced_to":{},"ntp_seconds_since_last_sync":{}}})",
      rfc3339(unix_us(now)), synced, json_text(synced ? ntp_address_ : ""),
      synced ? fmt::format("{}", seconds_since_sync(now)) : "null");
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
  position.time_s = 1e-6 * static_cast<double>(unix_us(now));
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
  ping_.report.validity_us = unix_us(reflected);
  const TimePoint leaves = config_.simulated_time ? now : std::max(now, reflected + config_.processing_delay);
  ping_.report.transmission_us = unix_us(leaves);
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
  velocity.since_last_ms = 1e-3 * static_cast<double>(microseconds_of(since));
  velocity.transmission_us = unix_us(now);
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
