// SPDX-License-Identifier: Apache-2.0
// The section `recording` of the configuration.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace sonard::server {

/// The clock that names of logs and times in .glf logs show.
enum class RecordingZone { utc, local };

/// When written data is forced onto the disk (docs/logs.md, "Recording").
enum class RecordingSync {
  never,         ///< when the kernel writes it
  on_close,      ///< a file when it is closed
  every_second,  ///< as on_close, and all open files once a second
};

/// Logs of what the heads send and receive.
struct RecordingConfig {
  std::filesystem::path directory;  ///< created if missing; used by one daemon at a time
  bool glf = true;                  ///< of heads whose type has this format
  bool mcap = true;
  bool mcap_wire_bytes = true;  ///< whether it holds the bytes of both directions
  bool mcap_foxglove = false;   ///< whether it holds images, poses and echoes for Foxglove
  bool mcap_zstd = false;       ///< whether its full chunks are compressed
  bool pcapng = true;
  bool sonar = true;                                      ///< of heads whose type has this format
  std::uint64_t rotate_bytes = std::uint64_t{512} << 20;  ///< if a file reaches this size, all files end
  std::chrono::nanoseconds rotate_after{std::chrono::hours{1}};  ///< > 0; all files end after this time
  RecordingZone zone = RecordingZone::utc;
  RecordingSync sync = RecordingSync::on_close;
  std::size_t queue_bytes = std::size_t{128} << 20;                 ///< further data is dropped
  std::chrono::nanoseconds stop_deadline{std::chrono::seconds{5}};  ///< for the queue at the daemon's end
};

}  // namespace sonard::server
