// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview ping360`.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
#include "protocol/ping360/messages.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct Ping360Options {
  LineAddress line;
  /// Settings, sector and step; without `automatic` its pings are ordered one by one.
  ping360::AutoTransmit scan;
  bool automatic = false;
  bool all_round = true;
  int ahead = 0;  ///< the angle that is drawn upwards, gradians
  double sound_speed_mps = 1500.0;

  std::uint64_t turns = 0;              ///< 0: without limit
  std::uint64_t pings = 0;              ///< 0: without limit
  std::chrono::nanoseconds duration{};  ///< from the first word of the head; 0: without limit
  std::chrono::nanoseconds wait{};  ///< patience for a line that cannot be opened and a head without a word
  std::chrono::nanoseconds ping_wait{};  ///< patience for the next ping; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< keep the pictures of each n-th turn; 0: only of the last
  int radius_px = 500;        ///< from the apex to the full range
  bool log_pings = false;
  bool quiet = false;

  double bin_m() const { return scan.sample_period * 25e-9 * sound_speed_mps / 2.0; }
};

/// The options of the subcommand.
class Ping360Arguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit Ping360Arguments(CLI::App& app);

  /// What they mean.
  /// @throws CLI::ValidationError
  Ping360Options options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void declare_run(CLI::App& app);
  void set_scan(Ping360Options& options) const;

  Ping360Options options_;
  // As they are typed, before they have their units.
  LinkArguments link_;
  double range_m_ = 10.0;
  int samples_ = 0;
  int frequency_khz_ = 740;
  int gain_ = 1;
  int step_ = 1;
  int delay_ms_ = 0;
  std::vector<double> sector_deg_;
  double seconds_ = 0.0;
  double wait_s_ = 10.0;
  double ping_wait_s_ = 30.0;
};

}  // namespace sonard::client
