// SPDX-License-Identifier: Apache-2.0
// Log sink for standard error that never blocks.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include <spdlog/sinks/base_sink.h>

namespace sonard::server {

/// If the reader has stopped (a full pipe, a held terminal), lines are dropped and counted, and the next line
/// that is written gives their number; also lines for which there is no memory. Any thread. A line is written
/// whole or not at all, except that a line longer than PIPE_BUF may be cut. Messages pass printable(),
/// because peers may have caused parts of them.
class StderrSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  /// @param descriptor stays open for as long as the sink lives; not modified, because other processes may
  /// share it
  explicit StderrSink(int descriptor = 2);
  ~StderrSink() override;
  StderrSink(const StderrSink&) = delete;
  StderrSink& operator=(const StderrSink&) = delete;

  /// Counts a line for which there was no memory; the sink itself counts the lines that it cannot make.
  void drop_line();

 private:
  enum class Kind : std::uint8_t {
    file,    ///< a write never blocks
    socket,  ///< each write has a flag not to block
    own,     ///< a pipe or terminal, opened again so that only our writes do not block
    polled,  ///< if it cannot be opened again: polled for room first
  };

  void sink_it_(const spdlog::details::log_msg& message) override;
  void write_line(const spdlog::details::log_msg& message);
  void flush_() override {}
  std::string dropped_text(const spdlog::details::log_msg& next);
  bool write(std::string_view text);

  int descriptor_;
  Kind kind_ = Kind::file;
  bool cut_ = false;                 ///< only part of the last line was written
  std::uint64_t dropped_ = 0;        ///< because stderr was blocked
  std::uint64_t out_of_memory_ = 0;  ///< dropped because there was no memory
};

}  // namespace sonard::server
