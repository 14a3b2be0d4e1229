// SPDX-License-Identifier: Apache-2.0
// The log on standard error, which never waits for its reader.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include <spdlog/sinks/base_sink.h>

namespace sonard::server {

/// Where a reader has stopped (a full pipe, a terminal that is held), lines are dropped and counted, and the
/// next one that goes out says how many were. Any thread; a line is written whole or not at all, except that
/// one longer than PIPE_BUF may be cut. The message of a line is printable(), whoever made up parts of it.
class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// @param descriptor stays open for as long as the sink lives; it is not changed, for other processes may
  ///   share it
  explicit StderrSink(int descriptor = 2);
  ~StderrSink() override;
  StderrSink(const StderrSink&) = delete;
  StderrSink& operator=(const StderrSink&) = delete;

 private:
  enum class Kind : std::uint8_t {
    file,    ///< a write never waits
    socket,  ///< each write says that it must not wait
    own,     ///< a pipe or terminal, opened again so that only our writes do not wait
    polled,  ///< where that is not possible: polled for room first
  };

  void sink_it_(const spdlog::details::log_msg& message) override;
  void flush_() override {}
  std::string dropped_text(const spdlog::details::log_msg& next);
  bool write(std::string_view text);

  int descriptor_;
  Kind kind_ = Kind::file;
  bool cut_ = false;  ///< the last line was written in part
  std::uint64_t dropped_ = 0;
};

}  // namespace sonard::server
