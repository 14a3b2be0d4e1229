// SPDX-License-Identifier: Apache-2.0
// The options of a viewer that are the same for every device: when it ends, and what it writes.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct RunOptions {
  std::uint64_t pings = 0;               ///< end after so many; 0: without limit
  std::chrono::nanoseconds duration{};   ///< from the first word of the head; 0: without limit
  std::chrono::nanoseconds wait{};       ///< patience for a head, and for a line to it that was lost
  std::chrono::nanoseconds ping_wait{};  ///< patience for the next ping; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< pictures of each n-th ping, or turn; 0: only of the last
  int radius_px = 0;          ///< of the picture, from the apex to the full range
  bool log_pings = false;
  bool quiet = false;
};

/// What a device's help calls things.
struct RunWords {
  const char* ping = "ping";     ///< "line": the options are --lines, --line-wait and --log-lines
  const char* picture = "ping";  ///< what a picture shows: a "ping" or a "turn"
  const char* wait = "Seconds to wait for the head, at the start and after its line was lost";
  const char* link_group = "Link";  ///< heading of the options that say how the head is reached
};

/// Those options on a command line.
class RunArguments {
 public:
  /// Both are defaults, of --size and --wait.
  RunArguments(int radius_px, double wait_s) : wait_s_(wait_s) { options_.radius_px = radius_px; }

  /// Declares them; `app` and this object then live until it has parsed.
  void declare(CLI::App& app, const RunWords& words);
  RunOptions options() const;

 private:
  RunOptions options_;
  // As they are typed.
  double seconds_ = 0.0;
  double wait_s_;
  double ping_wait_s_ = 30.0;
};

}  // namespace sonard::client
