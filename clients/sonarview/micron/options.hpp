// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview micron`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "protocol/micron/host.hpp"
#include "protocol/micron/scan_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct MicronOptions {
  LineAddress line;
  micron::HostConfig host;
  micron::ScanSettings scan;

  RunOptions run;             ///< its pings are lines
  std::uint64_t sweeps = 0;   ///< 0: without limit
  std::filesystem::path raw;  ///< file for the lines; empty: none
};

/// The options of the subcommand.
class MicronArguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit MicronArguments(CLI::App& app);

  /// What they mean.
  /// @throws CLI::ValidationError
  MicronOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void declare_run(CLI::App& app);
  micron::ScanSettings scan() const;

  MicronOptions options_;
  // As they are typed, before they have their units.
  LinkArguments link_;
  RunArguments run_{500, 10.0};
  int node_ = micron::default_head_node;
  double step_deg_ = 1.8;
  std::vector<double> sector_deg_;
  bool scan_left_ = false;
  bool four_bit_ = false;
};

}  // namespace sonard::client
