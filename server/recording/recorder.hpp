// SPDX-License-Identifier: Apache-2.0
// Writes what the heads report to logs, on its own thread.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/config/config.hpp"
#include "server/recording/event_queue.hpp"
#include "server/recording/log.hpp"

namespace sonard::server {

/// The folder of the logs cannot be used. what() names it and the reason.
struct RecordingError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Locks a folder for a moment, if there is one. @throws RecordingError if another daemon records into it
void try_recording_into(const std::filesystem::path& directory);

/// Counters, which only grow.
struct RecorderCounters {
  DroppedEvents dropped;           ///< the queue was full
  std::uint64_t images = 0;        ///< pings and scan lines that came through the queue
  std::uint64_t images_lost = 0;   ///< of those: lost, as no log could be written
  std::uint64_t logs_written = 0;  ///< closed without a failure
  std::uint64_t logs_failed = 0;   ///< could not be written, to the end or at all
};

/// The thread has a lower priority than those that serve. It takes events off the queue, encodes and
/// compresses them, and writes; no thread waits for it. What does not fit the queue is dropped, counted, and
/// shown in the log.
///
/// All logs of a daemon begin and end together, so that files of one name cover the same time. When one is
/// full, or time is over, the next event begins new ones. The .dat of the old ones are packed meanwhile, a
/// slice between any two checks of the queue: while it copies 1 MiB and waits for the disk events gather, at
/// most for as long as that takes.
///
/// Disk full, or any other error of a file: that file is abandoned (GrowingLog), the others continue. The
/// next logs begin only where there is room for them; until then events are discarded.
class Recorder {
 public:
  /// Free space below which no logs begin.
  static constexpr std::uint64_t least_room_bytes = std::uint64_t{16} << 20;

  /// Makes the folder, locks it against other daemons and recovers what is in it (recovery.hpp), then starts
  /// the thread.
  /// @throws RecordingError
  Recorder(const RecordingConfig& config, std::vector<HeadToRecord> heads);
  /// Calls stop().
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Any thread; never waits. An event that does not fit the queue is dropped and counted.
  void push(RecordingEvent event);
  /// Any thread. False: the logs that are open are closed, and what is pushed is left out, uncounted, until
  /// it is turned on again, with new logs.
  void turn(bool on);
  bool on() const;
  /// Writes what was pushed before, closes and packs the logs, and logs what was done. After
  /// RecordingConfig::stop_deadline it logs what is not on the disk, and leaves the thread to itself: the
  /// thread ends after the write that it waits in, and the next daemon repairs the logs.
  /// @return false if the thread was left; the same when called again
  bool stop();

  RecorderCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  ///< of the thread, too
};

}  // namespace sonard::server
