// SPDX-License-Identifier: Apache-2.0
// The logs that begin and end together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "server/recording/log.hpp"

namespace sonard::server {

class LogSet {
 public:
  /// @param begin of the first event
  /// @param has_room false: everything is thrown away
  LogSet(const RecordingConfig& config, const std::vector<HeadToRecord>& heads, TimePoint begin,
         bool has_room);
  ~LogSet() = default;
  LogSet(const LogSet&) = delete;  // logs refer to its setting
  LogSet& operator=(const LogSet&) = delete;

  void write(const RecordingEvent& event);
  /// False when there is no log that could be written, up to the last event.
  bool any_good() const;
  void flush(TimePoint now);
  void sync();
  /// True when the next event belongs into new logs.
  bool is_over(TimePoint now) const;

  /// What became of it.
  struct Closed {
    std::vector<std::filesystem::path> dats;  ///< to be packed
    std::uint64_t written = 0;
    std::uint64_t failed = 0;
  };
  Closed close();

 private:
  LogSetting setting_;
  TimePoint begin_;
  std::vector<std::unique_ptr<Log>> logs_;
};

}  // namespace sonard::server
