// SPDX-License-Identifier: Apache-2.0
#include "server/offline/progress.hpp"

#include <unistd.h>

#include <cmath>

#include <fmt/format.h>

#include "common/text/counted.hpp"
#include "server/clock/clock.hpp"

namespace sonard::server {
namespace {

constexpr std::chrono::nanoseconds bar_period = std::chrono::milliseconds{200};
constexpr std::chrono::nanoseconds line_period = std::chrono::seconds{10};
constexpr int bar_width = 30;

std::string time_text(double seconds) {
  const auto whole = std::llround(seconds);
  return whole < 3600 ? fmt::format("{}:{:02}", whole / 60, whole % 60)
                      : fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

std::string progress_text(const ProgressState& state) {
  const int done = state.found + state.made;
  const int percent = state.frames > 0 ? 100 * done / state.frames : 100;
  std::string text = fmt::format("{} of {}, {} %", done, counted(state.frames, "frame"), percent);
  const double seconds = std::chrono::duration<double>(state.elapsed).count();
  if (state.made > 0 && seconds > 0.0) {
    const double per_second = state.made / seconds;
    text += fmt::format(", {:.1f} per second, {} left", per_second,
                        time_text((state.frames - done) / per_second));
  }
  return text;
}

std::string found_text(int frames, int found) {
  return fmt::format("{} of {} exist; {} to render", found, counted(frames, "frame"), frames - found);
}

std::string interrupted_text(const ProgressState& state) {
  return fmt::format("interrupted: {} of {} exist; run the same command again to render the rest",
                     state.found + state.made, counted(state.frames, "frame"));
}

Progress::Progress(int frames, int found)
    : terminal_(isatty(STDERR_FILENO) == 1),
      state_{frames, found, 0, {}},
      started_(SteadyClock().now()),
      next_shown_(started_ + (terminal_ ? bar_period : line_period)) {}

void Progress::made(std::chrono::nanoseconds now) {
  ++state_.made;
  state_.elapsed = now - started_;
  if (now >= next_shown_) {
    next_shown_ = now + (terminal_ ? bar_period : line_period);
    show();
  }
}

void Progress::show() {
  if (!terminal_) {
    fmt::print(stderr, "{}\n", progress_text(state_));
    return;
  }
  const int filled = state_.frames > 0 ? bar_width * (state_.found + state_.made) / state_.frames : bar_width;
  fmt::print(stderr, "\r\033[K[{:<{}}] {}", std::string(static_cast<std::size_t>(filled), '#'), bar_width,
             progress_text(state_));
  std::fflush(stderr);
  bar_shown_ = true;
}

void Progress::end() {
  if (bar_shown_) {
    show();
    fmt::print(stderr, "\n");
    bar_shown_ = false;
  }
}

}  // namespace sonard::server
