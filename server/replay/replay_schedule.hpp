// SPDX-License-Identifier: Apache-2.0
// When each ping of a recording is due. Pure: time is an argument.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/clock/clock.hpp"

namespace sonard::server {

struct ReplayTiming {
  double speed = 1.0;     ///< > 0; 2: twice as fast as recorded
  bool as_asked = false;  ///< ignores the times of the recording: a ping for each that a client wants
  bool loop = false;      ///< from the start again after the last ping; a recording of one lasts a second
  bool start_now =
      false;  ///< the clock runs from the start, with or without clients; else from the first ping on
};

/// Keeps the heads of a recording in step.
///
/// The clock starts at the first ping that a client wants and waits for clients: a ping wanted late leaves
/// late, the next ones catch up, and where it was more than `most_behind` late the clock goes on from there,
/// so nothing is left out. With `start_now` it runs without clients too, and a ping that none wanted before
/// the next was due, or for `most_behind`, is skipped.
class ReplaySchedule {
 public:
  static constexpr std::chrono::nanoseconds most_behind = std::chrono::seconds{1};

  struct Ping {
    std::size_t image = 0;         ///< index into the times of the head
    std::optional<TimePoint> due;  ///< nullopt: as soon as a client wants it
  };

  /// @param times_ns of each head, rising, within 90 days; no head is without pings
  /// @param now when the clock starts, for ReplayTiming::start_now
  ReplaySchedule(std::vector<std::vector<std::int64_t>> times_ns, const ReplayTiming& timing, TimePoint now);

  /// The ping that is next at `now`; nullopt: the last one has been started or skipped.
  std::optional<Ping> next(std::size_t head, TimePoint now);
  /// The ping that next() named leaves at `transmit_time`.
  void started(std::size_t head, TimePoint transmit_time);

  /// True when no ping of any head is left at `now`.
  bool over(TimePoint now);
  std::uint64_t skipped() const { return skipped_; }

 private:
  struct Head {
    std::vector<std::chrono::nanoseconds> offsets;  ///< from the first ping of all
    std::size_t next = 0;                           ///< counts on over laps
  };

  bool has_next(const Head& head) const { return timing_.loop || head.next < head.offsets.size(); }
  TimePoint due(const Head& head, std::size_t ping) const;
  void skip_missed(Head& head, TimePoint now);

  ReplayTiming timing_;
  std::vector<Head> heads_;
  std::chrono::nanoseconds lap_{};  ///< at the speed of the recording
  std::optional<TimePoint> start_;
  std::uint64_t skipped_ = 0;
};

}  // namespace sonard::server
