// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview ping1d`.
#pragma once

#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "protocol/ping1d/messages.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct Ping1dOptions {
  LineAddress line;
  std::vector<ping1d::Command> settings;  ///< sent before the stream is requested
  RunOptions run;
};

/// Declares and reads the options of the subcommand.
class Ping1dArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit Ping1dArguments(CLI::App& app);

  /// The parsed options, converted.
  /// @throws CLI::ValidationError
  Ping1dOptions options() const;

 private:
  // As typed, before the conversion of units.
  LinkArguments link_;
  RunArguments run_{500, 10.0};
  double range_m_ = 0.0;
  double start_m_ = 0.0;
  int gain_ = -1;
  int interval_ms_ = 100;
  double sound_speed_mps_ = 1500.0;
};

}  // namespace sonard::client
