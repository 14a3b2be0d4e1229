// SPDX-License-Identifier: Apache-2.0
// How far a run is, for people.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>

namespace sonard::server {

/// Frames of this process.
struct ProgressState {
  int frames = 0;  ///< to be there in the end
  int found = 0;   ///< frames that existed before it began
  int made = 0;    ///< since then
  std::chrono::nanoseconds elapsed{0};
};

/// "120 of 300 frames, 40 %, 8.1 a second, 0:22 left"; the last two as soon as there is something to tell
/// them from.
std::string progress_text(const ProgressState& state);

/// What a run begins with where frames of an earlier one are there: "40 of 300 frames are there; 260 to
/// render".
std::string found_text(int frames, int found);
/// What one that was interrupted leaves: "interrupted: 120 of 300 frames are there; the same command goes
/// on".
std::string interrupted_text(const ProgressState& state);

/// Shows it on standard error: on a terminal as a bar, elsewhere as a line now and then.
class Progress {
 public:
  Progress(int frames, int found);

  /// One more frame is done.
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
