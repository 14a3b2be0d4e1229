// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/controls.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocol/sonar3d15/utc_text.hpp"

namespace sonard::sonar3d15 {

using nlohmann::json;

namespace {

constexpr Release with_automatic_speed{1, 7, 0}, with_time{1, 7, 1};
constexpr std::string_view base = "/api/v1/integration/";
constexpr double hot_c = 55.0, too_hot_c = 60.0;
constexpr double least_speed_mps = 1000.0, most_speed_mps = 2000.0;
constexpr std::size_t longest_host = 253;

constexpr std::array udp_modes{"multicast", "unicast", "disabled"};  // in the order of UdpMode
constexpr std::string_view page =
    "<!doctype html><title>Sonar 3D-15</title><p>sonard emulates this sonar. It has no web page.</p>\n";

std::string text_of(const json& value) {
  return value.dump(-1, ' ', true);
}

/// A member of an object, or `missing`.
json member(const json& value, const char* name, const json& missing = {}) {
  return value.is_object() && value.contains(name) ? value[name] : missing;
}

/// No valid body has as many objects; nested ones would need much stack.
bool nests_deeply(std::string_view text) {
  constexpr std::ptrdiff_t most = 8;
  return std::ranges::count_if(text, [](char c) { return c == '[' || c == '{'; }) > most;
}

std::optional<Ipv4> parse_address(std::string_view text) {
  Ipv4 address = 0;
  for (int octet = 0; octet < 4; ++octet) {
    unsigned value = 0;
    const std::size_t size = std::min(text.find('.'), text.size());
    const bool digits = size >= 1 && size <= 3 && std::ranges::all_of(text.substr(0, size), [](char c) {
                          return c >= '0' && c <= '9';
                        });
    if (!digits || (octet == 3) != (size == text.size())) {
      return std::nullopt;
    }
    for (const char c : text.substr(0, size)) {
      value = 10 * value + static_cast<unsigned>(c - '0');
    }
    if (value > 255) {
      return std::nullopt;
    }
    address = address << 8 | value;
    text.remove_prefix(std::min(size + 1, text.size()));
  }
  return address;
}

json status_entry(const char* name, const char* message, const char* level, bool older) {
  const bool normal = std::string_view(level) == "ok";
  return {{"id", fmt::format("{}-{}", name, normal ? "normal" : level)},
          {"message", message},
          {"operational", std::string_view(level) != "error"},
          {older ? "severity" : "status", older && normal ? "info" : level}};
}

/// A path. Each setter returns the status of the reply.
struct Resource {
  std::string_view path;
  Release since;
  json (*get)(const Controls&, TimePoint);  ///< nullptr: Controls::values_, or only POST
  int (*post)(Controls&, TimePoint,
              json&);    ///< nullptr: only GET. It may bring the value into its usual form
  bool reports = false;  ///< a POST is answered by the result of `get`
};

}  // namespace

/// What the paths read and set.
struct Resources {
  static json about(const Controls& controls, TimePoint) {
    const Release& release = controls.config_.release;
    const std::string version = fmt::format("{}.{}.{}", release.major, release.minor, release.patch);
    return {{"chipid", "0x12345678"},
            {"hardware_revision", 6},
            {"is_ready", true},
            {"product_id", 21045},
            {"product_name", "Sonar 3D-15"},
            {"variant", ""},
            {"version", version + " (emulated)"},
            {"version_short", version}};
  }

  static json status(const Controls& controls, TimePoint) {
    const DeviceConfig& config = controls.config_;
    const bool older = config.release < with_automatic_speed;
    const char* const level = config.temperature_c < hot_c       ? "ok"
                              : config.temperature_c < too_hot_c ? "warning"
                                                                 : "error";
    json status{{"api", status_entry("api", "Integration API is operational", "ok", older)},
                {"temperature", status_entry("temperature", "Internal temperature", level, older)}};
    const char* const check = older ? "calibration" : "systems_check";
    status[check] = status_entry(check, "All checks passed", "ok", older);
    if (config.release >= with_time) {
      status["time"] =
          status_entry("time", config.ntp_synced ? "Time is synchronised" : "Time is not synchronised",
                       config.ntp_synced ? "ok" : "warning", older);
    }
    return status;
  }

  static json temperature(const Controls& controls, TimePoint) { return controls.config_.temperature_c; }

  static json time_status(const Controls& controls, TimePoint now) {
    const bool synced = controls.config_.ntp_synced;
    const auto age = std::chrono::floor<std::chrono::seconds>(now - controls.synced_at_).count();
    return {
        {"system_time", utc_text(controls.utc(now))},
        {"ntp_synced", synced},
        {"ntp_synced_to", synced ? json::parse(controls.values_.at("time/ntp"))["ntp_address"] : json("")},
        {"ntp_seconds_since_last_sync", synced ? json(age) : json()}};
  }

  static json sync_result(const Controls& controls, TimePoint now) {
    const bool synced = controls.config_.ntp_synced;
    return {{"success", synced},
            {"message", synced ? "Time is synchronised" : "No time server answered"},
            {"status", time_status(controls, now)}};
  }

  static int set_acoustics(Controls& controls, TimePoint, json& body) {
    if (!body.is_boolean()) {
      return 400;
    }
    if (body == true && controls.config_.temperature_c >= too_hot_c) {
      return 409;
    }
    controls.settings_.acoustics = body == true;
    return 204;
  }

  static int set_mode(Controls& controls, TimePoint, json& body) {
    controls.settings_.high_frequency = body == "high-frequency";
    return body == "high-frequency" || body == "low-frequency" ? 204 : 400;
  }

  static int set_range(Controls& controls, TimePoint, json& body) {
    const json least = member(body, "min"), most = member(body, "max");
    if (!least.is_number() || !most.is_number() || least < 0 || most <= least ||
        most > controls.config_.most_range_m) {
      return 400;
    }
    controls.settings_.least_range_m = least;
    controls.settings_.range_m = most;
    body = {{"min", least}, {"max", most}};
    return 204;
  }

  static int set_salinity(Controls&, TimePoint, json& body) {
    return body == "salt" || body == "fresh" ? 204 : 400;
  }

  static int set_speed(Controls& controls, TimePoint now, json& body) {
    const bool automatic = body == 0 && controls.config_.release >= with_automatic_speed;
    if (!body.is_number() || (!automatic && (body < least_speed_mps || body > most_speed_mps))) {
      return 400;
    }
    controls.former_speed_mps_ = controls.sound_speed_mps(now);
    controls.speed_since_ = now + controls.config_.speed_change_time;
    controls.settings_.sound_speed_mps = body;
    return 204;
  }

  static int set_imu(Controls& controls, TimePoint, json& body) {
    if (!body.is_boolean()) {
      return 400;
    }
    controls.settings_.imu_batches = body == true;
    return 204;
  }

  /// Address and port may be missing if they are not used.
  static int set_udp(Controls& controls, TimePoint, json& body) {
    const auto mode = std::ranges::find(udp_modes, member(body, "mode"));
    const json address = member(body, "unicast_destination_ip", ""),
               port = member(body, "unicast_destination_port", 0);
    if (mode == udp_modes.end() || !address.is_string() || !port.is_number_integer() || port < 0 ||
        port > 65535) {
      return 400;
    }
    const auto index = static_cast<UdpMode>(mode - udp_modes.begin());
    const Endpoint unicast{parse_address(address.get<std::string>()).value_or(0), port.get<std::uint16_t>()};
    if (index == UdpMode::unicast && (unicast.address == 0 || unicast.port == 0)) {
      return 400;
    }
    controls.settings_.udp_mode = index;
    controls.settings_.unicast = unicast;
    body = {{"mode", *mode}, {"unicast_destination_ip", address}, {"unicast_destination_port", port}};
    return 204;
  }

  static int set_time(Controls& controls, TimePoint now, json& body) {
    const json text = member(body, "now");
    const auto utc = text.is_string() ? parse_utc(text) : std::nullopt;
    if (!utc) {
      return 400;
    }
    if (controls.config_.ntp_synced) {
      return 409;
    }
    controls.clock_shift_ += *utc - controls.utc(now);
    return 204;
  }

  static int set_ntp(Controls&, TimePoint, json& body) {
    const json address = member(body, "ntp_address");
    const std::size_t size = address.is_string() ? address.get<std::string>().size() : 0;
    body = {{"ntp_address", address}};
    return size > 0 && size <= longest_host ? 204 : 400;
  }

  static int force_sync(Controls& controls, TimePoint now, json& body) {
    if (const json timeout = member(body, "timeout_seconds"); !timeout.is_number() || timeout < 0) {
      return 400;
    }
    if (controls.config_.ntp_synced) {
      controls.synced_at_ = now;
    }
    return 200;
  }

  static Reply get(const Controls& controls, TimePoint now, const Resource& resource) {
    if (const auto value = controls.values_.find(resource.path); value != controls.values_.end()) {
      return {200, value->second};
    }
    if (resource.get == nullptr || resource.reports) {
      return {405, "\"use POST\""};
    }
    return {200, text_of(resource.get(controls, now))};
  }

  static Reply post(Controls& controls, TimePoint now, const Resource& resource, const std::string& text) {
    if (resource.post == nullptr) {
      return {405, "\"use GET\""};
    }
    json body = nests_deeply(text) ? json(json::value_t::discarded) : json::parse(text, nullptr, false);
    const Settings before = controls.settings_;
    const int status = body.is_discarded() ? 400 : resource.post(controls, now, body);
    if (status == 200) {
      return {200, text_of(resource.get(controls, now))};
    }
    if (status != 204) {
      controls.settings_ = before;
      return {status, status == 409 ? "\"not possible in this state\"" : "\"wrong type or value\""};
    }
    if (const auto value = controls.values_.find(resource.path); value != controls.values_.end()) {
      value->second = text_of(body);
    }
    return {204, ""};
  }
};

namespace {

constexpr std::array resources{
    Resource{"about", {1, 4, 0}, Resources::about, nullptr},
    Resource{"acoustics/enabled", {1, 4, 0}, nullptr, Resources::set_acoustics},
    Resource{"acoustics/mode", {1, 7, 0}, nullptr, Resources::set_mode},
    Resource{"acoustics/range", {1, 4, 0}, nullptr, Resources::set_range},
    Resource{"acoustics/salinity", {1, 7, 0}, nullptr, Resources::set_salinity},
    Resource{"acoustics/speed_of_sound", {1, 1, 0}, nullptr, Resources::set_speed},
    Resource{"output/imu-batch/enabled", {1, 8, 0}, nullptr, Resources::set_imu},
    Resource{"status", {1, 1, 0}, Resources::status, nullptr},
    Resource{"temperature", {1, 4, 0}, Resources::temperature, nullptr},
    Resource{"time/manual", {1, 7, 1}, nullptr, Resources::set_time},
    Resource{"time/ntp", {1, 7, 1}, nullptr, Resources::set_ntp},
    Resource{"time/ntp/force-sync", {1, 7, 1}, Resources::sync_result, Resources::force_sync, true},
    Resource{"time/status", {1, 7, 1}, Resources::time_status, nullptr},
    Resource{"udp", {1, 5, 0}, nullptr, Resources::set_udp},
};

}  // namespace

Controls::Controls(const DeviceConfig& config, TimePoint start)
    : config_(config),
      clock_shift_(config.ntp_synced ? std::chrono::nanoseconds{} : config.clock_offset),
      speed_since_(start),
      synced_at_(start) {
  settings_.acoustics = config.acoustics && config.temperature_c < too_hot_c;
  settings_.least_range_m = config.least_range_m;
  settings_.range_m = config.range_m;
  settings_.sound_speed_mps = config.release < with_automatic_speed ? config.automatic_sound_speed_mps : 0.0;
  settings_.udp_mode = config.udp_mode;
  settings_.unicast = config.unicast;
  const bool unicast = config.udp_mode == UdpMode::unicast;
  const json udp{{"mode", udp_modes.at(static_cast<std::size_t>(config.udp_mode))},
                 {"unicast_destination_ip", unicast ? address_text(config.unicast.address) : ""},
                 {"unicast_destination_port", config.unicast.port}};
  values_ = {{"acoustics/enabled", text_of(settings_.acoustics)},
             {"acoustics/mode", R"("low-frequency")"},
             {"acoustics/range", text_of({{"min", config.least_range_m}, {"max", config.range_m}})},
             {"acoustics/salinity", R"("salt")"},
             {"acoustics/speed_of_sound", text_of(settings_.sound_speed_mps)},
             {"output/imu-batch/enabled", "false"},
             {"time/ntp", R"({"ntp_address":"auto"})"},
             {"udp", text_of(udp)}};
}

Reply Controls::answer(TimePoint now, const Request& request) {
  std::string_view path = request.path;
  const bool get = request.method == "GET";
  if (path == "/" && get) {
    return {200, std::string(page), "text/html; charset=utf-8"};
  }
  if (path == "/api/v1/about") {
    return Resources::get(*this, now, resources.front());
  }
  const bool below = path.starts_with(base);
  path.remove_prefix(below ? base.size() : 0);
  const auto resource = std::ranges::find(resources, path, &Resource::path);
  if (!below || resource == resources.end() || resource->since > config_.release) {
    return {404, "\"not found\""};
  }
  if (get) {
    return Resources::get(*this, now, *resource);
  }
  return request.method == "POST" ? Resources::post(*this, now, *resource, request.body)
                                  : Reply{405, "\"use GET or POST\""};
}

double Controls::sound_speed_mps(TimePoint now) const {
  if (now < speed_since_) {
    return former_speed_mps_;
  }
  return settings_.sound_speed_mps > 0.0 ? settings_.sound_speed_mps : config_.automatic_sound_speed_mps;
}

std::optional<Endpoint> Controls::destination() const {
  switch (settings_.udp_mode) {
    case UdpMode::multicast:
      return multicast_group;
    case UdpMode::unicast:
      return settings_.unicast;
    default:
      return std::nullopt;
  }
}

}  // namespace sonard::sonar3d15
