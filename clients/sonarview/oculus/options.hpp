// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview oculus`.
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
  std::string head;            ///< address; empty: the address in the first status
  std::uint16_t port = 52100;  ///< of the head
  Ipv4 bind_address = 0;       ///< statuses arrive here; 0: all addresses
  std::uint16_t status_port = 52102;
  oculus::SimpleFire fire;

  RunOptions run;
};

/// Declares and reads the options of the subcommand.
class OculusArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit OculusArguments(CLI::App& app);

  /// The parsed options, converted.
  /// @throws CLI::ValidationError
  OculusOptions options() const;

 private:
  void declare_link(CLI::App& app);
  void declare_sonar(CLI::App& app);

  OculusOptions options_;
  // As typed, before the conversion of units.
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
