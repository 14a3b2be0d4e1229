// SPDX-License-Identifier: Apache-2.0
// What the user asks of `sonarview oculus`.
#pragma once

#include <cstdint>
#include <string>

#include "clients/sonarview/common/run_options.hpp"
#include "protocol/common/endpoint.hpp"
#include "protocol/oculus/messages.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct OculusOptions {
  std::string head;            ///< address; empty: that of the first status
  std::uint16_t port = 52100;  ///< of the head
  Ipv4 bind_address = 0;       ///< statuses arrive here; 0: on all addresses
  std::uint16_t status_port = 52102;
  oculus::SimpleFire fire;

  RunOptions run;
};

/// The options of the subcommand.
class OculusArguments {
 public:
  /// Declares them; `app` and this object then live until it has parsed.
  explicit OculusArguments(CLI::App& app);

  /// What they mean.
  /// @throws CLI::ValidationError
  OculusOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);

  OculusOptions options_;
  // As they are typed, before they have their units.
  RunArguments run_{900, 10.0};
  std::string bind_address_ = "0.0.0.0";
  std::string frequency_ = "low";
  double range_m_ = 20.0;
  int beams_ = 512;
  int bits_ = 8;
  int rate_hz_ = 10;
  bool row_gains_ = false;
};

}  // namespace sonard::client
