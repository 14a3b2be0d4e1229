// SPDX-License-Identifier: Apache-2.0
// The pings of a log in any format, for replay and `sonard info`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "server/logs/log_file.hpp"

namespace sonard::server {

/// True within 146 years of 1970, so that differences of times cannot overflow.
constexpr bool plausible_time(std::int64_t time_ns) {
  constexpr std::int64_t limit_ns = std::int64_t{1} << 62;
  return time_ns > -limit_ns && time_ns < limit_ns;
}

/// One ping of a log, without its samples.
struct LoggedPing {
  /// Since the Unix epoch. A .glf has local time without a zone, which counts as UTC here.
  std::int64_t time_ns = 0;
  RecordedSettings settings;
  double bearing_rad = 0.0;        ///< of a scanning head's beam, see PingRecord::bearings_rad
  int bits_per_bin = 8;            ///< 8: samples are 0..255; 4: 0..15
  std::vector<std::uint8_t> wire;  ///< the message without samples; empty: not in the log
  std::size_t place = 0;           ///< index in the reader
};

struct LoggedHead {
  std::string name;  ///< empty if the log has no name
  std::string type;  ///< its type in the configuration; empty if the log does not have it
  std::uint16_t device_id = 0;
  bool scanning = false;          ///< true: a ping is a line of one beam
  std::vector<LoggedPing> pings;  ///< at least one, in the order of their times
  /// Bearings of a multibeam head's first ping: one per beam in the order of samples, see
  /// PingRecord::bearings_rad.
  std::vector<double> bearings_rad;
};

/// Reads on demand from the mapped file; any thread.
class LogReader {
 public:
  LogReader() = default;
  virtual ~LogReader() = default;
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// In the order of their first pings.
  const std::vector<LoggedHead>& heads() const { return heads_; }
  /// bins * beams samples, bin after bin from the nearest, beams from port to starboard.
  /// @throws Error if they cannot be unpacked
  virtual std::vector<std::uint8_t> samples(const LoggedPing& ping) const = 0;
  /// Problems of the log, one phrase each: cut, not closed, damaged inside.
  virtual std::vector<std::string> problems() const = 0;
  /// True if the log was closed properly.
  virtual bool closed() const = 0;
  /// Kind and number of the records that are not pings, if this reader counts them.
  virtual std::vector<std::pair<std::string, std::uint64_t>> other_records() const { return {}; }

 protected:
  LoggedHead& head(const std::string& name, std::uint16_t device_id, bool scanning);
  /// Call it once, when all pings are added.
  void sort_by_time();

 private:
  std::vector<LoggedHead> heads_;
};

/// A type of device (HeadType) of this class has logs of its own kind, which hold the datagrams of one head.
class PacketLogDevice {
 public:
  PacketLogDevice() = default;
  virtual ~PacketLogDevice() = default;
  PacketLogDevice(const PacketLogDevice&) = delete;
  PacketLogDevice& operator=(const PacketLogDevice&) = delete;

  virtual LogKind packet_log() const = 0;
  /// @throws Error as open_log()
  virtual std::unique_ptr<LogReader> open_packet_log(const LogFile& file) const = 0;
};

/// Opens a log of a PacketLogDevice.
using PacketLogOpener = std::function<std::unique_ptr<LogReader>(const LogFile& file)>;

/// @throws Error if `file` is broken at its start or its kind holds no images (.pcapng). Undecodable pings
/// are left out. `file` must outlive the recording.
std::unique_ptr<LogReader> open_log(const LogFile& file, const PacketLogOpener& open_packet_log);

}  // namespace sonard::server
