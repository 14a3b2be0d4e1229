// SPDX-License-Identifier: Apache-2.0
// What clients say: JSON objects, sentences on the serial line and requests by HTTP; and the answers.
#include <charconv>
#include <cmath>
#include <utility>

#include "protocol/dvl_a50/device_impl.hpp"
#include "protocol/dvl_a50/http.hpp"
#include "protocol/dvl_a50/sentences.hpp"
#include "protocol/dvl_a50/utc.hpp"

namespace sonard::dvl_a50 {
namespace {

constexpr milliseconds position_after_reset{50};
constexpr milliseconds serial_patience{10};  ///< between the characters of a command (6)
constexpr std::size_t most_line_bytes = 256;
constexpr int most_triggers = 15;
constexpr double longest_force_sync_s = 60.0;

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

template <class T>
const T* member(const Json::Members& parameters, std::string_view name) {
  const auto found = std::ranges::find(parameters, name, &std::pair<std::string, Json>::first);
  return found != parameters.end() ? found->second.as<T>() : nullptr;
}

}  // namespace

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
  if (command && !command->checked) {
    ++counters_.bad_checksums;
    send_serial(with_checksum("wr!"));
    return;
  }
  const auto fits = [&](const SerialRule& rule) {
    return command && rule.name == command->name && command->options.size() >= rule.least_options &&
           command->options.size() <= rule.most_options;
  };
  const auto rule = std::ranges::find_if(serial_rules(), fits);
  const Outcome outcome =
      rule != serial_rules().end() ? rule->run(*this, now, command->options) : Outcome{.understood = false};
  if (!outcome.understood) {
    ++counters_.unreadable;
    send_serial(with_checksum("wr?"));
    return;
  }
  ++counters_.commands;
  if (!outcome.error.empty()) {
    refuse("serial",
           fmt::format("the serial command {} failed: {}", json_text(command->name), outcome.error));
  }
  const std::string done = outcome.result == "null" ? "wra" : outcome.result;
  answer(now, serial_peer(), with_checksum(outcome.error.empty() ? done : "wrn") + "\r\n", outcome.delay);
}

const std::vector<Device::Impl::SerialRule>& Device::Impl::serial_rules() {
  using Options = const std::vector<std::string>&;
  static const std::vector<SerialRule> all{
      {"wcv", 0, 0,
       [](Impl& it, TimePoint, Options) {
         return Outcome{{}, fmt::format("wrv,{}", texts_of(it.config_.release).serial)};
       }},
      {"wcw", 0, 0,
       [](Impl& it, TimePoint, Options) {
         const DeviceConfig& config = it.config_;
         return Outcome{{},
                        fmt::format("wrw,{},{},{}", config.serial_name, texts_of(config.release).version,
                                    config.chip_id)};
       }},
      {"wcc", 0, 0,
       [](Impl& it, TimePoint, Options) {
         return Outcome{{}, settings_text(it.settings_)};
       }},
      {"wcr", 0, 0, [](Impl& it, TimePoint now, Options) { return it.reset(now, {}); }},
      {"wcg", 0, 0, [](Impl& it, TimePoint now, Options) { return it.calibrate(now, {}); }},
      {"wcx", 0, 0, [](Impl& it, TimePoint now, Options) { return it.trigger(now, {}); }},
      {"wcs", 4, 6, [](Impl& it, TimePoint, Options options) { return it.set_serial_settings(options); }},
      {"wcp", 1, 1, [](Impl& it, TimePoint, Options options) { return it.set_serial_output(options[0]); }},
      {"wcn", 1, 1,
       [](Impl& it, TimePoint now, Options options) {
         return it.set_ntp(now, {{"ntp_address", Json{options[0]}}});
       }},
      {"wcN", 0, 0,
       [](Impl& it, TimePoint, Options) {
         return Outcome{{}, "wrN," + it.clock_.server()};
       }},
      {"wcm", 1, 1,
       [](Impl& it, TimePoint now, Options options) { return it.set_time(now, whole_number(options[0])); }},
      {"wcT", 1, 1,
       [](Impl& it, TimePoint, Options) {
         return Outcome{{}, it.clock_.synced() ? "wrT,y" : "wrT,n"};
       }},
      {"wct", 0, 0, [](Impl& it, TimePoint now, Options) {
         return Outcome{{}, it.clock_.status_sentence(now)};
       }}};
  return all;
}

Device::Impl::Outcome Device::Impl::set_serial_settings(const std::vector<std::string>& options) {
  Settings wanted = settings_;
  if (!apply(options, wanted)) {
    return {.understood = false};
  }
  if (const auto wrong = wrong_setting(wanted, config_.release)) {
    return {"invalid value for " + *wrong};
  }
  use(wanted);
  return {};
}

Device::Impl::Outcome Device::Impl::set_serial_output(const std::string& option) {
  if (option.size() != 1 || std::string_view("01236").find(option) == std::string_view::npos) {
    return {.understood = false};
  }
  serial_output_ = option[0] - '0';
  return {};
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
  const auto* const address = member<std::string>(parameters, "ntp_address");
  return address != nullptr && clock_.set_server(*address) ? Outcome{}
                                                           : Outcome{"invalid value for ntp_address"};
}

Device::Impl::Outcome Device::Impl::get_ntp(TimePoint, const Json::Members&) {
  return {{}, fmt::format(R"({{"ntp_address":{}}})", json_text(clock_.server()))};
}

Device::Impl::Outcome Device::Impl::set_time(TimePoint now, const Json::Members& parameters) {
  const auto* const wanted = member<std::string>(parameters, "now");
  return set_time(now, wanted != nullptr ? parse_rfc3339(*wanted) : std::nullopt);
}

Device::Impl::Outcome Device::Impl::set_time(TimePoint now, std::optional<std::int64_t> unix_us) {
  if (clock_.synced()) {
    return {"Manual time not allowed when NTP is synchronized"};
  }
  return clock_.set(now, unix_us) ? Outcome{} : Outcome{"invalid value for now"};
}

Device::Impl::Outcome Device::Impl::force_sync(TimePoint now, const Json::Members& parameters) {
  const auto* const timeout_s = member<double>(parameters, "timeout_seconds");
  if (timeout_s == nullptr || *timeout_s < 0.0) {
    return {"invalid value for timeout_seconds"};
  }
  const bool synced = clock_.synced();
  const double delay_s = synced ? 0.0 : std::min(*timeout_s, longest_force_sync_s);
  return {{},
          fmt::format(R"({{"success":{},"message":"NTP force-sync {}","status":{}}})", synced,
                      synced ? "successful" : "not successful within timeout", clock_.status_json(now)),
          nanoseconds{std::llround(1e9 * delay_s)}};
}

std::string Device::Impl::version_text() const {
  const std::string_view version = texts_of(config_.release).version;
  return fmt::format(
      R"({{"chipid":{},"hardware_revision":4,"product_id":{},"product_name":{},"variant":"standard",)"
      R"x("version_short":"{}","version":"{} (sonard)","is_ready":true}})x",
      json_text(config_.chip_id), config_.product_id, json_text(config_.product_name), version, version);
}

}  // namespace sonard::dvl_a50
