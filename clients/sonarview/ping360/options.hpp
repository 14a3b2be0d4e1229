// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview ping360`.
#pragma once

#include <cstdint>
#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "protocol/ping360/messages.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct Ping360Options {
  LineAddress line;
  /// Settings, sector and step. Without `automatic`, pings are requested one by one.
  ping360::AutoTransmit scan;
  bool automatic = false;
  bool all_round = true;
  int ahead = 0;  ///< the angle that points up in pictures, gradians
  double sound_speed_mps = 1500.0;

  RunOptions run;
  std::uint64_t turns = 0;  ///< 0: no limit

  double bin_m() const { return scan.sample_period * 25e-9 * sound_speed_mps / 2.0; }
};

/// Declares and reads the options of the subcommand.
class Ping360Arguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit Ping360Arguments(CLI::App& app);

  /// The parsed options, converted.
  /// @throws CLI::ValidationError
  Ping360Options options() const;

 private:
  void declare_sonar(CLI::App& app);
  void set_scan(Ping360Options& options) const;

  Ping360Options options_;
  // As typed, before the conversion of units.
  LinkArguments link_;
  RunArguments run_{500, 10.0};
  double range_m_ = 10.0;
  int samples_ = 0;
  int frequency_khz_ = 740;
  int gain_ = 1;
  int step_ = 1;
  int delay_ms_ = 0;
  std::vector<double> sector_deg_;
};

}  // namespace sonard::client
