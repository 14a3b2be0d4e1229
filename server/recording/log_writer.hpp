// SPDX-License-Identifier: Apache-2.0
// Common parts of all logs of a recording.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "server/recording/events.hpp"
#include "server/recording/growing_log.hpp"
#include "server/recording/recording_config.hpp"

namespace sonard::server {

class GlfDevice;

/// Description of a head for its logs.
struct HeadToRecord {
  std::string name;
  std::string type;                ///< its type in the configuration
  std::uint16_t device_id = 0;     ///< its ID on the wire
  const GlfDevice* glf = nullptr;  ///< null: the head has no .glf logs
  bool has_packet_log = false;     ///< the head has .sonar logs
};

/// Shared by all logs that begin together. Both clocks are read at the beginning and kept, so that times in a
/// log never jump.
struct LogSetting {
  const RecordingConfig& config;
  const std::vector<HeadToRecord>& heads;  ///< by RecordingEvent::head
  std::chrono::nanoseconds unix_offset{};  ///< from TimePoint to Unix time
  std::int32_t utc_offset_s = 0;           ///< of the zone of the logs
  std::string stem;                        ///< of file names

  std::int64_t unix_ns(TimePoint time) const { return (time + unix_offset).count(); }
};

/// A file that records the events it supports. The file is created at the first such event.
class LogWriter {
 public:
  explicit LogWriter(const LogSetting& setting) : setting_(setting), file_(setting.config.sync) {}
  virtual ~LogWriter() = default;
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  virtual void write(const RecordingEvent& event) = 0;
  /// Writes all data so far to the file, so that it survives the end of this process.
  /// @param now time of the last event
  virtual void flush(TimePoint now) = 0;
  /// Closes the log; nothing is written after that.
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
