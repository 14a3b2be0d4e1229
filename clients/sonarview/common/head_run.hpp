// SPDX-License-Identifier: Apache-2.0
// What a viewer does for one head of any type: limits of the run, messages, pictures, exit status.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "clients/sonarview/common/exit_status.hpp"
#include "clients/sonarview/common/image_writer.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "protocol/common/ping_job.hpp"

namespace sonard::client {

/// The counters that each summary prints.
struct RunCounters {
  std::uint64_t pings = 0;
  double rate_hz = 0.0;  ///< pings per second, from the first ping to the last; valid after HeadRun::finish()
  std::uint64_t reconnects = 0;
  std::uint64_t images_written = 0;
  std::uint64_t images_skipped = 0;
};

/// The present time of the steady clock.
TimePoint steady_now();

double in_seconds(std::chrono::nanoseconds time);

class HeadRun {
 public:
  /// What ends the run.
  enum class Limit { none, duration, no_head, no_ping };

  /// @param says prefix of messages
  /// @param out folder for pictures; empty: no pictures
  /// @throws std::runtime_error (folder)
  HeadRun(const RunOptions& options, const std::filesystem::path& out, std::string says = "sonarview: ");

  TimePoint started() const { return started_; }
  /// The head's first message has arrived.
  void meet(TimePoint at);
  bool met() const { return met_at_.has_value(); }
  /// Begins the wait for the head, or for the next ping, again.
  void wait_from(TimePoint at) { waiting_since_ = at; }
  void count_ping(TimePoint received);
  /// Once a second, if the head is met: the number of pings since the last time.
  std::optional<std::uint64_t> fresh_pings(TimePoint at);

  /// @param listens false: the line is lost, so nothing can be expected from the head
  Limit limit(TimePoint at, bool listens) const;
  /// When to call fresh_pings() and limit() next.
  TimePoint next_wake(bool listens) const;

  /// Prints a message, unless --quiet.
  void say(const std::string& message) const;
  /// Prints a message, always.
  void warn(const std::string& message) const;
  /// Prints a message; the run ends with the first such status.
  void fail(ExitStatus failure, const std::string& message);

  /// Null if no pictures are wanted.
  ImageWriter* writer() { return writer_ ? &*writer_ : nullptr; }
  RunCounters& counters() { return counters_; }
  const RunCounters& counters() const { return counters_; }
  /// Writes the waiting pictures and completes the counters.
  void finish();
  ExitStatus status(bool all_arrived) const;

 private:
  const RunOptions options_;
  const std::string says_;
  const TimePoint started_ = steady_now();
  std::optional<TimePoint> met_at_;
  TimePoint waiting_since_ = started_;  ///< start of the wait for the head, or for the next ping
  TimePoint first_ping_at_{};
  TimePoint last_ping_at_{};
  TimePoint progress_due_{};
  std::uint64_t pings_at_progress_ = 0;
  RunCounters counters_;
  std::optional<ImageWriter> writer_;
  std::optional<ExitStatus> failure_;
};

}  // namespace sonard::client
