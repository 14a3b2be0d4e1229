// SPDX-License-Identifier: Apache-2.0
// A summary of a log, in numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/logs/recording.hpp"

namespace sonard::server {

/// All images, in a row or not, with the same settings.
struct SettingsCount {
  RecordedSettings settings;
  std::uint64_t pings = 0;
};

/// Times of pings: how regularly they came.
struct PingRate {
  double median_interval_s = 0.0;  ///< 0 with less than two pings
  std::uint64_t gaps = 0;          ///< intervals of more than twice the median
  double longest_gap_s = 0.0;      ///< 0 without gaps

  double rate_hz() const { return median_interval_s > 0.0 ? 1.0 / median_interval_s : 0.0; }
};

/// @param times_ns rising
PingRate ping_rate(const std::vector<std::int64_t>& times_ns);

struct HeadSummary {
  std::string name;                     ///< empty where the log has none
  std::string device;                   ///< its type in the configuration; empty where the log does not say
  std::uint16_t id = 0;                 ///< its ID on the wire
  bool scanning = false;                ///< a ping is a line of one beam
  std::vector<SettingsCount> settings;  ///< in order of appearance
  std::vector<std::int64_t> times_ns;   ///< of pings, rising; the clock is that of LoggedPing

  std::uint64_t pings() const { return times_ns.size(); }
};

struct LogSummary {
  std::string path;
  LogKind kind = LogKind::glf;
  std::uint64_t size_bytes = 0;
  std::optional<bool> closed;  ///< nullopt: logs of this kind do not say
  bool local_time = false;     ///< times are those of an unknown zone, counted as if that were UTC
  std::optional<std::pair<std::int64_t, std::int64_t>> span_ns;  ///< first and last time of anything
  std::vector<HeadSummary> heads;
  std::vector<std::pair<std::string, std::uint64_t>> other_records;  ///< what, and how many
  std::vector<std::string> problems;                                 ///< one phrase each
};

/// Finds the beginning of a ping in a datagram; made by the kind of device.
struct PingSeen {
  std::string device;
  std::uint16_t device_id = 0;
  RecordedSettings settings;
};
using PingFinder = std::function<std::optional<PingSeen>(std::span<const std::uint8_t> datagram)>;

/// @param ping_in finds the pings of a .pcapng
/// @throws LogError when the log is broken from its start
LogSummary summarise(const LogFile& file, const PingFinder& ping_in);

/// Adds a ping; times come in any order, and summarise() sorts them.
void add_ping(HeadSummary& head, std::int64_t time_ns, const RecordedSettings& settings);
/// The head of this name, device, ID and way of pinging, which it adds where there is none.
HeadSummary& head_of(LogSummary& log, const std::string& name, const std::string& device, std::uint16_t id,
                     bool scanning);
/// Leaves out what is no plausible_time().
void include(LogSummary& log, std::int64_t time_ns);
void count(LogSummary& log, const std::string& what, std::uint64_t records = 1);

}  // namespace sonard::server
