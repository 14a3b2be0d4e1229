// SPDX-License-Identifier: Apache-2.0
#include "server/info/info_text.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <optional>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/text/printable.hpp"

#include "server/devices/types/types.hpp"

namespace sonard::server {
namespace {

constexpr std::size_t most_settings_shown = 8;
constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t to_utc(const LogSummary& log, std::int64_t time_ns, std::int32_t utc_offset_s) {
  return log.local_time ? time_ns - utc_offset_s * second_ns : time_ns;
}

std::string offset_text(std::int32_t utc_offset_s) {
  const int minutes = std::abs(utc_offset_s) / 60;
  return fmt::format("{}{:02}:{:02}", utc_offset_s < 0 ? '-' : '+', minutes / 60, minutes % 60);
}

std::string title_of(const HeadSummary& head, LogKind log) {
  const DeviceType* const type = type_of_logged(head.type, head.scanning, log);
  const std::string_view usual = head.scanning ? "scanning sonar" : "multibeam sonar";
  return fmt::format("{} {}{}", type != nullptr ? type->title() : usual, head.id,
                     head.name.empty() ? "" : fmt::format(" '{}'", printable(head.name)));
}

std::string settings_text(const RecordedSettings& settings, bool scanning) {
  std::string text = scanning ? fmt::format("{} bins", settings.bins)
                              : fmt::format("{} range bins of {} beams", settings.bins, settings.beams);
  text +=
      fmt::format(", range {:.2f} m, sound speed {:.1f} m/s", settings.range_m(), settings.sound_speed_mps);
  if (settings.gain_percent >= 0.0) {
    text += fmt::format(", gain {:.0f} %", settings.gain_percent);
  }
  if (settings.frequency_hz > 0.0) {
    text += fmt::format(", {:.0f} kHz", 1e-3 * settings.frequency_hz);
  }
  return text;
}

std::string rate_text(const PingRate& rate) {
  if (rate.median_interval_s <= 0.0) {
    return "";
  }
  std::string text = fmt::format("{:.2f} per second, median interval {:.1f} ms; ", rate.rate_hz(),
                                 1e3 * rate.median_interval_s);
  return text + (rate.gaps == 0 ? "no gaps"
                                : fmt::format("{} gaps of more than twice that, the longest {:.3f} s",
                                              rate.gaps, rate.longest_gap_s));
}

std::string head_text(const HeadSummary& head, LogKind log) {
  std::string text = fmt::format("head     {}: {} {}\n", title_of(head, log), head.pings(),
                                 head.scanning ? "lines" : "pings");
  if (const std::string rate = rate_text(ping_rate(head.times_ns)); !rate.empty()) {
    text += fmt::format("         {}\n", rate);
  }
  for (std::size_t i = 0; i < std::min(head.settings.size(), most_settings_shown); ++i) {
    text += fmt::format("         {}x {}\n", head.settings[i].pings,
                        settings_text(head.settings[i].settings, head.scanning));
  }
  if (head.settings.size() > most_settings_shown) {
    text += fmt::format("         and {} more settings\n", head.settings.size() - most_settings_shown);
  }
  return text;
}

std::string span_text(const LogSummary& log, std::int32_t utc_offset_s) {
  const auto [first, last] = *log.span_ns;
  std::string text;
  if (log.local_time) {
    text = fmt::format("span     {} to {} as written\n         {} to {} if the clock was at UTC{}\n",
                       iso_time(first, false), iso_time(last, false),
                       iso_time(to_utc(log, first, utc_offset_s), true),
                       iso_time(to_utc(log, last, utc_offset_s), true), offset_text(utc_offset_s));
  } else {
    text = fmt::format("span     {} to {}\n", iso_time(first, true), iso_time(last, true));
  }
  return text + fmt::format("         {:.3f} s\n", 1e-9 * static_cast<double>(last - first));
}

// ---- JSON

using Json = nlohmann::ordered_json;

/// The value, or null if the log does not have it.
Json json_known(bool known, double value) {
  return known ? Json(value) : Json();
}

Json json_settings(const SettingsCount& count) {
  const RecordedSettings& settings = count.settings;
  return {{"pings", count.pings},
          {"bins", settings.bins},
          {"beams", settings.beams},
          {"bin_m", settings.bin_m},
          {"range_m", settings.range_m()},
          {"sound_speed_mps", settings.sound_speed_mps},
          {"gain_percent", json_known(settings.gain_percent >= 0.0, settings.gain_percent)},
          {"frequency_hz", json_known(settings.frequency_hz > 0.0, settings.frequency_hz)}};
}

Json json_head(const HeadSummary& head, LogKind log) {
  const PingRate rate = ping_rate(head.times_ns);
  const DeviceType* const type = type_of_logged(head.type, head.scanning, log);
  const std::string name = type != nullptr ? std::string(type->name()) : head.type;
  Json settings = Json::array();
  for (const SettingsCount& count : head.settings) {
    settings.push_back(json_settings(count));
  }
  return {{"type", name.empty() ? Json() : Json(name)},
          {"scanning", head.scanning},
          {"name", head.name},
          {"id", head.id},
          {"pings", head.pings()},
          {"rate_hz", rate.rate_hz()},
          {"median_interval_s", rate.median_interval_s},
          {"gaps", rate.gaps},
          {"longest_gap_s", rate.longest_gap_s},
          {"settings", settings}};
}

Json json_span(const LogSummary& log, std::int32_t utc_offset_s) {
  if (!log.span_ns) {
    return nullptr;
  }
  const auto [first, last] = *log.span_ns;
  return {{"first_as_written", iso_time(first, !log.local_time)},
          {"last_as_written", iso_time(last, !log.local_time)},
          {"first_utc", iso_time(to_utc(log, first, utc_offset_s), true)},
          {"last_utc", iso_time(to_utc(log, last, utc_offset_s), true)},
          {"utc_offset_s", log.local_time ? utc_offset_s : 0},
          {"seconds", 1e-9 * static_cast<double>(last - first)}};
}

}  // namespace

std::string iso_time(std::int64_t time_ns, bool utc) {
  const std::int64_t whole_s =
      std::chrono::floor<std::chrono::seconds>(std::chrono::nanoseconds(time_ns)).count();
  const std::time_t time = whole_s;
  std::tm parts{};
  gmtime_r(&time, &parts);
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:03}{}", parts, (time_ns - whole_s * second_ns) / 1'000'000,
                     utc ? "Z" : "");
}

std::int32_t local_utc_offset_s(std::int64_t local_time_ns) {
  const std::time_t as_utc = local_time_ns / second_ns;
  std::tm parts{};
  gmtime_r(&as_utc, &parts);
  parts.tm_isdst = -1;
  return static_cast<std::int32_t>(as_utc - std::mktime(&parts));
}

std::string info_text(const LogSummary& log, std::int32_t utc_offset_s) {
  std::string text =
      fmt::format("log      {}: {}, {} bytes{}\n", printable(log.path), name_of(log.kind), log.size_bytes,
                  !log.closed   ? ""
                  : *log.closed ? ", closed"
                                : ", not closed");
  if (log.span_ns) {
    text += span_text(log, utc_offset_s);
  }
  for (const HeadSummary& head : log.heads) {
    text += head_text(head, log.kind);
  }
  if (log.heads.empty()) {
    text += "head     none\n";
  }
  for (const auto& [what, number] : log.other_records) {
    text += fmt::format("also     {} {}\n", number, printable(what));
  }
  return text;
}

std::string info_json(const LogSummary& log, std::int32_t utc_offset_s) {
  Json heads = Json::array();
  for (const HeadSummary& head : log.heads) {
    heads.push_back(json_head(head, log.kind));
  }
  Json others = Json::object();
  for (const auto& [what, number] : log.other_records) {
    others[what] = number;
  }
  const Json json{{"file", log.path},
                  {"kind", name_of(log.kind).substr(1)},
                  {"bytes", log.size_bytes},
                  {"closed", log.closed ? Json(*log.closed) : Json()},
                  {"span", json_span(log, utc_offset_s)},
                  {"heads", heads},
                  {"other_records", others},
                  {"problems", log.problems}};
  return json.dump(-1, ' ', /*ensure_ascii=*/true, Json::error_handler_t::replace) + "\n";
}

}  // namespace sonard::server
