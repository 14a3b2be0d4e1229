// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview micron`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "protocol/micron/client.hpp"
#include "protocol/micron/scan_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct MicronOptions {
  LineAddress line;
  micron::ClientConfig client;
  micron::ScanSettings scan;

  RunOptions run;             ///< a ping is a line
  std::uint64_t sweeps = 0;   ///< 0: no limit
  std::filesystem::path raw;  ///< file for the lines; empty: not written
};

/// Declares and reads the options of the subcommand.
class MicronArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit MicronArguments(CLI::App& app);

  /// The parsed options, converted.
  /// @throws CLI::ValidationError
  MicronOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);
  void declare_run(CLI::App& app);
  micron::ScanSettings scan() const;

  MicronOptions options_;
  // As typed, before the conversion of units.
  LinkArguments link_;
  RunArguments run_{500, 10.0};
  int node_ = micron::default_head_node;
  double step_deg_ = 1.8;
  std::vector<double> sector_deg_;
  bool scan_left_ = false;
  bool four_bit_ = false;
};

}  // namespace sonard::client
