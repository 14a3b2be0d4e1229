// SPDX-License-Identifier: Apache-2.0
// What all logs of a recording have in common.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/glf/records.hpp"
#include "server/config/config.hpp"
#include "server/recording/events.hpp"
#include "server/recording/growing_log.hpp"

namespace sonard::server {

/// A head for its logs.
struct HeadToRecord {
  std::string name;
  std::string device;           ///< its type in the configuration
  std::uint16_t device_id = 0;  ///< its ID on the wire
  /// Where the users of such heads know .glf logs: its place among those, 0..9.
  std::optional<std::uint8_t> glf_number;
  /// What a status of the head says in fields that a .glf has; nullopt for other messages to everybody.
  /// Empty: it has no such status.
  std::function<std::optional<glf::StatusRecord>(std::span<const std::uint8_t>)> glf_status;
};

/// Shared by all logs that begin together. Both clocks are read when they begin and hold for all of them,
/// so that times in a log never jump.
struct LogSetting {
  const RecordingConfig& config;
  const std::vector<HeadToRecord>& heads;  ///< by RecordingEvent::head
  std::chrono::nanoseconds unix_offset{};  ///< from TimePoint to Unix time
  std::int32_t utc_offset_s = 0;           ///< of the zone of the logs
  std::string stem;                        ///< of names

  std::int64_t unix_ns(TimePoint time) const { return (time + unix_offset).count(); }
};

/// A file that takes what it understands of the events. The file is made when the first such event comes.
class Log {
 public:
  explicit Log(const LogSetting& setting) : setting_(setting), file_(setting.config.sync) {}
  virtual ~Log() = default;
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;

  virtual void write(const RecordingEvent& event) = 0;
  /// Hands to the file what was written so far, so that it survives the end of this process.
  /// @param now of the last event
  virtual void flush(TimePoint now) = 0;
  /// Nothing is written after that.
  virtual void close() = 0;

  GrowingLog& file() { return file_; }
  const GrowingLog& file() const { return file_; }

 protected:
  const LogSetting& setting() const { return setting_; }

 private:
  const LogSetting& setting_;
  GrowingLog file_;
};

}  // namespace sonard::server
