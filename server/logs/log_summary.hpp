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

#include "server/logs/log_reader.hpp"

namespace sonard::server {

/// Number of images with the same settings, consecutive or not.
struct SettingsCount {
  RecordedSettings settings;
  std::uint64_t pings = 0;
};

/// Regularity of the ping times.
struct PingRate {
  double median_interval_s = 0.0;  ///< 0 if there are fewer than two pings
  std::uint64_t gaps = 0;          ///< intervals of more than twice the median
  double longest_gap_s = 0.0;      ///< 0 if there are no gaps

  double rate_hz() const { return median_interval_s > 0.0 ? 1.0 / median_interval_s : 0.0; }
};

/// @param times_ns in rising order
PingRate ping_rate(const std::vector<std::int64_t>& times_ns);

struct HeadSummary {
  std::string name;                     ///< empty if the log has no name
  std::string type;                     ///< its type in the configuration; empty if the log does not have it
  std::uint16_t id = 0;                 ///< its ID on the wire
  bool scanning = false;                ///< true: a ping is a line of one beam
  std::vector<SettingsCount> settings;  ///< in order of appearance
  std::vector<std::int64_t> times_ns;   ///< of pings, in rising order; the clock is as in LoggedPing

  std::uint64_t pings() const { return times_ns.size(); }
};

struct LogSummary {
  std::string path;
  LogKind kind = LogKind::glf;
  std::uint64_t size_bytes = 0;
  std::optional<bool> closed;  ///< nullopt: logs of this kind do not record it
  bool local_time = false;     ///< true: times are of an unknown zone, counted as UTC
  std::optional<std::pair<std::int64_t, std::int64_t>> span_ns;  ///< first and last time of any record
  std::vector<HeadSummary> heads;
  std::vector<std::pair<std::string, std::uint64_t>> other_records;  ///< kind and number
  std::vector<std::string> problems;                                 ///< one phrase each
};

/// A ping found in a datagram by a type of device.
struct CapturedPing {
  std::string type;
  std::uint16_t device_id = 0;
  RecordedSettings settings;
};
/// A type of device (HeadType) of this class recognises its pings in captures.
class CaptureReader {
 public:
  CaptureReader() = default;
  virtual ~CaptureReader() = default;
  CaptureReader(const CaptureReader&) = delete;
  CaptureReader& operator=(const CaptureReader&) = delete;

  /// The start of a ping in a datagram; nullopt for other datagrams and resent pings.
  virtual std::optional<CapturedPing> ping_in(std::span<const std::uint8_t> datagram) const = 0;
};

using PingFinder = std::function<std::optional<CapturedPing>(std::span<const std::uint8_t> datagram)>;

/// @param ping_in finds the pings of a .pcapng
/// @throws Error if the log is broken at its start
LogSummary summarise(const LogFile& file, const PingFinder& ping_in, const PacketLogOpener& open_packet_log);

/// Adds a ping; times may come in any order, because summarise() sorts them.
void add_ping(HeadSummary& head, std::int64_t time_ns, const RecordedSettings& settings);
/// The head with this name, type, ID and way of pinging; added if it is new.
HeadSummary& head_of(LogSummary& log, const std::string& name, const std::string& type, std::uint16_t id,
                     bool scanning);
/// Extends the span of the log; ignores times that are not plausible_time().
void include(LogSummary& log, std::int64_t time_ns);
void count(LogSummary& log, const std::string& what, std::uint64_t records = 1);

}  // namespace sonard::server
