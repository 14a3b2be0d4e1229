// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/codec.hpp"

#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "protocol/dvl_a50/range_mode.hpp"

namespace sonard::dvl_a50 {
namespace {

std::string bare_zero(double value) {
  return value == 0.0 ? "0" : json_number(value);
}

std::string row_text(const Vector& row) {
  return fmt::format("[{},{},{}]", bare_zero(row[0]), bare_zero(row[1]), bare_zero(row[2]));
}

std::string beam_text(const Beam& beam) {
  return fmt::format(R"({{"id":{},"velocity":{},"distance":{},"rssi":{},"nsd":{},"beam_valid":{}}})", beam.id,
                     json_number(beam.velocity_mps), json_number(beam.distance_m), json_number(beam.rssi_dbm),
                     json_number(beam.nsd_dbm), beam.valid);
}

/// "1475.00", or all digits if there are more.
std::string setting_text(double value) {
  return std::round(100.0 * value) == 100.0 * value ? fmt::format("{:.2f}", value) : json_number(value);
}

/// Reads members of an object; remembers whether one was missing.
class Members {
 public:
  explicit Members(const Json& object) : object_(object) {}

  template <class T>
  T get(std::string_view name) {
    const Json* const member = object_.find(name);
    const T* const value = member != nullptr ? member->as<T>() : nullptr;
    complete_ = complete_ && value != nullptr;
    return value != nullptr ? *value : T{};
  }
  double number(std::string_view name) { return get<double>(name); }
  std::int64_t integer(std::string_view name) {
    const double value = number(name);
    complete_ = complete_ && std::abs(value) < 9e15;
    return complete_ ? static_cast<std::int64_t>(value) : 0;
  }
  bool complete() const { return complete_; }
  void require(bool condition) { complete_ = complete_ && condition; }

 private:
  const Json& object_;
  bool complete_ = true;
};

Vector vector_of(const Json::List& list, Members& members) {
  Vector vector{};
  members.require(list.size() == 3);
  for (std::size_t i = 0; i < 3 && members.complete(); ++i) {
    members.require(list[i].as<double>() != nullptr);
    vector[i] = members.complete() ? *list[i].as<double>() : 0.0;
  }
  return vector;
}

std::optional<Beam> decode_beam(const Json& object) {
  Members members(object);
  const Beam beam{.id = static_cast<int>(members.integer("id") & 3),
                  .velocity_mps = members.number("velocity"),
                  .distance_m = members.number("distance"),
                  .rssi_dbm = members.number("rssi"),
                  .nsd_dbm = members.number("nsd"),
                  .valid = members.get<bool>("beam_valid")};
  return members.complete() ? std::optional(beam) : std::nullopt;
}

template <class T>
bool take(const Json& value, T& target) {
  const T* const typed = value.as<T>();
  if (typed != nullptr) {
    target = *typed;
  }
  return typed != nullptr;
}

bool take_setting(std::string_view name, const Json& value, Release release, Settings& settings) {
  if (name == "speed_of_sound") {
    return take(value, settings.speed_of_sound_mps);
  }
  if (name == "acoustic_enabled") {
    return take(value, settings.acoustic_enabled);
  }
  if (name == "dark_mode_enabled") {
    return take(value, settings.dark_mode_enabled);
  }
  if (name == "mounting_rotation_offset") {
    return take(value, settings.mounting_rotation_offset_deg);
  }
  if (name == "range_mode" && release >= Release::v2_2_1) {
    return take(value, settings.range_mode);
  }
  return name == "periodic_cycling_enabled" && release >= Release::v2_4_0 &&
         take(value, settings.periodic_cycling_enabled);
}

}  // namespace

std::string encode(const Velocity& report, std::string_view format) {
  const auto& [rows, beams] = std::tie(report.covariance, report.beams);
  return fmt::format(
      R"({{"time":{},"vx":{},"vy":{},"vz":{},"fom":{},"covariance":[{},{},{}],{}"transducers":[{},{},{},{}],)"
      R"("velocity_valid":{},"status":{},"format":"{}","type":"{}","time_of_validity":{},"time_of_transmission":{}}})",
      json_number(report.since_last_ms), json_number(report.velocity_mps[0]),
      json_number(report.velocity_mps[1]), json_number(report.velocity_mps[2]), json_number(report.fom_mps),
      row_text(rows[0]), row_text(rows[1]), row_text(rows[2]),
      report.of_water ? "" : fmt::format("\"altitude\":{},", json_number(report.altitude_m)),
      beam_text(beams[0]), beam_text(beams[1]), beam_text(beams[2]), beam_text(beams[3]), report.valid,
      report.status, format, report.of_water ? "velocity_water" : "velocity", report.validity_us,
      report.transmission_us);
}

std::string encode(const Position& report, std::string_view format) {
  return fmt::format(
      R"({{"ts":{},"x":{},"y":{},"z":{},"std":{},"roll":{},"pitch":{},"yaw":{},"type":"position_local","status":{},)"
      R"("format":"{}"}})",
      json_number(report.time_s), json_number(report.position_m[0]), json_number(report.position_m[1]),
      json_number(report.position_m[2]), json_number(report.std_m), json_number(report.roll_deg),
      json_number(report.pitch_deg), json_number(report.yaw_deg), report.status, format);
}

std::string encode(const Response& response, std::string_view command, std::string_view format) {
  return fmt::format(
      R"({{"response_to":{},"success":{},"error_message":{},"result":{},"format":"{}","type":"response"}})",
      json_text(command), response.error.empty(), json_text(response.error), response.result, format);
}

std::string encode(const Settings& settings, Release release) {
  std::string text = fmt::format(
      R"({{"speed_of_sound":{},"acoustic_enabled":{},"dark_mode_enabled":{},"mounting_rotation_offset":{})",
      setting_text(settings.speed_of_sound_mps), settings.acoustic_enabled, settings.dark_mode_enabled,
      setting_text(settings.mounting_rotation_offset_deg));
  if (release >= Release::v2_2_1) {
    text += fmt::format(R"(,"range_mode":{})", json_text(settings.range_mode));
  }
  if (release >= Release::v2_4_0) {
    text += fmt::format(R"(,"periodic_cycling_enabled":{})", settings.periodic_cycling_enabled);
  }
  return text + "}";
}

std::optional<std::string> apply(const Json::Members& parameters, Release release, Settings& settings) {
  Settings wanted = settings;
  for (const auto& member : parameters) {
    if (!take_setting(member.first, member.second, release, wanted)) {
      return member.first;
    }
  }
  if (auto wrong = wrong_setting(wanted, release)) {
    return wrong;
  }
  settings = wanted;
  return std::nullopt;
}

std::optional<std::string> wrong_setting(const Settings& settings, Release release) {
  const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
  if (!within(settings.speed_of_sound_mps, 1000.0, 2000.0)) {
    return "speed_of_sound";
  }
  if (!within(settings.mounting_rotation_offset_deg, 0.0, 360.0)) {
    return "mounting_rotation_offset";
  }
  const auto choice = parse_range_mode(settings.range_mode);
  return !choice || (choice->water && release < Release::v2_7_1) ? std::optional<std::string>("range_mode")
                                                                 : std::nullopt;
}

std::optional<Velocity> decode_velocity(const Json& message) {
  Members members(message);
  const auto type = members.get<std::string>("type");
  Velocity report{.of_water = type == "velocity_water",
                  .since_last_ms = members.number("time"),
                  .velocity_mps = {members.number("vx"), members.number("vy"), members.number("vz")},
                  .fom_mps = members.number("fom"),
                  .valid = members.get<bool>("velocity_valid"),
                  .status = static_cast<int>(members.integer("status") & 0xFF),
                  .validity_us = members.integer("time_of_validity"),
                  .transmission_us = members.integer("time_of_transmission")};
  members.require(report.of_water || type == "velocity");
  report.altitude_m = report.of_water ? -1.0 : members.number("altitude");
  const auto rows = members.get<Json::List>("covariance");
  members.require(rows.size() == 3);
  for (std::size_t i = 0; i < 3 && members.complete(); ++i) {
    const auto* const row = rows[i].as<Json::List>();
    members.require(row != nullptr);
    report.covariance[i] = row != nullptr ? vector_of(*row, members) : Vector{};
  }
  const auto beams = members.get<Json::List>("transducers");
  members.require(beams.size() == report.beams.size());
  for (std::size_t i = 0; i < report.beams.size() && members.complete(); ++i) {
    const std::optional<Beam> beam = decode_beam(beams[i]);
    members.require(beam.has_value());
    report.beams[i] = beam.value_or(Beam{});
  }
  return members.complete() ? std::optional(report) : std::nullopt;
}

std::optional<Position> decode_position(const Json& message) {
  Members members(message);
  const Position report{.time_s = members.number("ts"),
                        .position_m = {members.number("x"), members.number("y"), members.number("z")},
                        .std_m = members.number("std"),
                        .roll_deg = members.number("roll"),
                        .pitch_deg = members.number("pitch"),
                        .yaw_deg = members.number("yaw"),
                        .status = static_cast<int>(members.integer("status") & 0xFF)};
  members.require(members.get<std::string>("type") == "position_local");
  return members.complete() ? std::optional(report) : std::nullopt;
}

}  // namespace sonard::dvl_a50
