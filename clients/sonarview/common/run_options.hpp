// SPDX-License-Identifier: Apache-2.0
// The options that all viewers share: limits of the run, and output.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct RunOptions {
  std::uint64_t pings = 0;               ///< end after this number; 0: no limit
  std::chrono::nanoseconds duration{};   ///< from the first message of the head; 0: no limit
  std::chrono::nanoseconds wait{};       ///< longest wait for a head, and for a lost line to come back
  std::chrono::nanoseconds ping_wait{};  ///< longest wait for the next ping; 0: no limit

  std::filesystem::path out;  ///< folder for pictures; empty: no pictures
  std::uint64_t every = 0;    ///< keep pictures of each n-th ping, or turn; 0: only of the last
  int radius_px = 0;          ///< of the picture, from the apex to the full range
  bool log_pings = false;
  bool quiet = false;
};

/// Words in a device's help.
struct RunWords {
  const char* ping = "ping";     ///< "line": the options are --lines, --line-wait and --log-lines
  const char* picture = "ping";  ///< a picture shows a "ping" or a "turn"
  const char* wait = "Seconds to wait for the head, at the start and after its line was lost";
  const char* link_group = "Link";  ///< heading of the options of the connection
};

/// Declares and reads the options of RunOptions.
class RunArguments {
 public:
  /// Defaults of --size and --wait.
  RunArguments(int radius_px, double wait_s) : wait_s_(wait_s) { options_.radius_px = radius_px; }

  /// Declares the options. `app` and this object must live until `app` has parsed.
  void declare(CLI::App& app, const RunWords& words);
  RunOptions options() const;

 private:
  RunOptions options_;
  // As typed.
  double seconds_ = 0.0;
  double wait_s_;
  double ping_wait_s_ = 30.0;
};

}  // namespace sonard::client
