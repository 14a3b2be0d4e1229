// SPDX-License-Identifier: Apache-2.0
// Progress of a run, for people.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace sonard::server {

/// Frame counts of this process.
struct ProgressState {
  int frames = 0;  ///< frames when all are done
  int found = 0;   ///< frames that existed before this run
  int made = 0;    ///< frames made by this run
  std::chrono::nanoseconds elapsed{0};
};

/// "120 of 300 frames, 40 %, 8.1 per second, 0:22 left"; the last two when the rate is known.
std::string progress_text(const ProgressState& state);

/// First line of a run that continues another: "40 of 300 frames exist; 260 to render".
std::string found_text(int frames, int found);
/// Last line of an interrupted run: "interrupted: 120 of 300 frames exist; run the same command again ...".
std::string interrupted_text(const ProgressState& state);

/// Prints progress on standard error: a bar on a terminal, otherwise a line from time to time.
class Progress {
 public:
  Progress(int frames, int found);

  /// Counts one more frame.
  void made(std::chrono::nanoseconds now);
  /// Ends the bar, so that a line can follow.
  void end();
  const ProgressState& state() const { return state_; }

 private:
  void show();

  bool terminal_;
  ProgressState state_;
  std::chrono::nanoseconds started_;
  std::chrono::nanoseconds next_shown_;
  bool bar_shown_ = false;
};

}  // namespace sonard::server
