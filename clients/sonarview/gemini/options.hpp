// SPDX-License-Identifier: Apache-2.0
// The options of sonarview for a Gemini 720i.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/sonarview/common/run_options.hpp"
#include "protocol/common/endpoint.hpp"
#include "protocol/gemini/ping_settings.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct GeminiOptions {
  Ipv4 client_address = 0;  ///< source address of commands; 0: the address that routes to the head
  Ipv4 bind_address = 0;    ///< reports arrive here; 0: all addresses
  Ipv4 head_address = 0;    ///< 0: the alternate address in the status
  std::vector<std::uint16_t> sonar_ids{0};  ///< the heads to view; 0: the first whose status arrives
  gemini::PingSettings settings;

  RunOptions run;

  double drop_rx = 0.0;  ///< share of datagrams dropped on purpose, 0..1
  double drop_tx = 0.0;
  std::uint64_t seed = 1;
};

/// Declares and reads the options of the program without a subcommand.
class GeminiArguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit GeminiArguments(CLI::App& app);

  /// The parsed options, converted.
  /// @throws CLI::ValidationError
  GeminiOptions options() const;

 private:
  GeminiOptions options_;
  // As typed, before the conversion of units.
  RunArguments run_{900, 5.0};
  std::string client_address_;
  std::string bind_address_ = "0.0.0.0";
  std::string head_address_;
  int bits_ = 8;
  double interval_ms_ = 0.0;
};

}  // namespace sonard::client
