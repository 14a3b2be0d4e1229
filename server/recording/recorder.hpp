// SPDX-License-Identifier: Apache-2.0
// Writes the events of heads to logs, on its own thread.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/recording/event_queue.hpp"
#include "server/recording/log_writer.hpp"
#include "server/recording/recording_config.hpp"

namespace sonard::server {

/// Locks a folder for a moment, if it exists. @throws Error if another daemon records into it
void try_recording_into(const std::filesystem::path& directory);

/// Counters; they only grow.
struct RecorderCounters {
  DroppedEvents dropped;           ///< the queue was full
  std::uint64_t images = 0;        ///< pings and scan lines taken from the queue
  std::uint64_t images_lost = 0;   ///< images that no log could store
  std::uint64_t logs_written = 0;  ///< closed without an error
  std::uint64_t logs_failed = 0;   ///< not written, completely or in part
};

/// The thread has a lower priority than the serving threads. It takes events from the queue, encodes,
/// compresses and writes them; no thread waits for it. Events that do not fit the queue are dropped, counted,
/// and logged.
///
/// All logs of a daemon begin and end together, so that files of one name cover the same time. When a log is
/// full, or its time is over, the next event begins new logs. The old .dat files are packed meanwhile, one
/// slice between any two checks of the queue. Events gather only while it copies 1 MiB and waits for the
/// disk.
///
/// If the disk is full, or a file has another error, that file is abandoned (GrowingLog) and the others
/// continue. New logs begin only if there is room for them; until then events are discarded.
class Recorder {
 public:
  /// Minimum free space for new logs.
  static constexpr std::uint64_t least_room_bytes = std::uint64_t{16} << 20;

  /// Creates the folder, locks it against other daemons, recovers its logs (recovery.hpp), then starts the
  /// thread.
  /// @throws Error
  Recorder(const RecordingConfig& config, std::vector<HeadToRecord> heads);
  /// Calls stop().
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Any thread; never blocks. An event that does not fit the queue is dropped and counted.
  void push(RecordingEvent event);
  /// Whether the logs of a head store its status messages; any thread.
  bool stores_statuses(int head) const;
  /// Any thread. False: closes the open logs and ignores new events, uncounted, until recording is turned on
  /// again, with new logs.
  void turn(bool on);
  bool on() const;
  /// Writes all pushed events, closes and packs the logs, and logs totals. After
  /// RecordingConfig::stop_deadline it logs how much is not on the disk and abandons the thread. The thread
  /// then ends after its current write, and the next daemon repairs the logs.
  /// @return false if the thread was abandoned; also if called again
  bool stop();

  RecorderCounters counters() const;

 private:
  struct Impl;
  std::shared_ptr<Impl> impl_;  ///< shared with the thread
};

}  // namespace sonard::server
