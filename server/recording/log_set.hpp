// SPDX-License-Identifier: Apache-2.0
// The logs that begin and end together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "server/recording/log_writer.hpp"

namespace sonard::server {

class LogSet {
 public:
  /// @param unix_offset from TimePoint to Unix time
  /// @param begin time of the first event
  /// @param has_room false: everything is discarded
  LogSet(const RecordingConfig& config, const std::vector<HeadToRecord>& heads,
         std::chrono::nanoseconds unix_offset, TimePoint begin, bool has_room);
  ~LogSet() = default;
  LogSet(const LogSet&) = delete;  // logs refer to its setting
  LogSet& operator=(const LogSet&) = delete;

  void write(const RecordingEvent& event);
  /// True if at least one log has begun and has not failed.
  bool any_good() const;
  void flush(TimePoint now);
  void sync();
  /// True if the next event belongs into new logs.
  bool is_over(TimePoint now) const;

  /// Results of close().
  struct Closed {
    std::vector<std::filesystem::path> dats;  ///< to be packed
    std::uint64_t written = 0;
    std::uint64_t failed = 0;
  };
  Closed close();

 private:
  LogSetting setting_;
  TimePoint begin_;
  std::vector<std::unique_ptr<LogWriter>> logs_;
};

}  // namespace sonard::server
