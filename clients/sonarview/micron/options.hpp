// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview micron`.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "clients/sonarview/common/link_arguments.hpp"
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

  std::uint64_t sweeps = 0;             ///< 0: without limit
  std::uint64_t lines = 0;              ///< 0: without limit
  std::chrono::nanoseconds duration{};  ///< from the head's first message; 0: without limit
  std::chrono::nanoseconds wait{};  ///< patience for a line that cannot be opened and a head without a word
  std::chrono::nanoseconds line_wait{};  ///< patience for the next line of the scan; 0: without limit

  std::filesystem::path out;  ///< folder for pictures; empty: none
  std::uint64_t every = 0;    ///< keep the pictures of each n-th turn; 0: only of the last
  int radius_px = 500;        ///< from the apex to the full range
  std::filesystem::path raw;  ///< file for the lines; empty: none
  bool log_lines = false;
  bool quiet = false;
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
  int node_ = micron::default_head_node;
  double step_deg_ = 1.8;
  std::vector<double> sector_deg_;
  bool scan_left_ = false;
  bool four_bit_ = false;
  double seconds_ = 0.0;
  double wait_s_ = 10.0;
  double line_wait_s_ = 30.0;
};

}  // namespace sonard::client
