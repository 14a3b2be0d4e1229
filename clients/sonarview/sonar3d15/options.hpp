// SPDX-License-Identifier: Apache-2.0
// The options of `sonarview sonar3d15`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "clients/sonarview/common/run_options.hpp"
#include "protocol/common/endpoint.hpp"
#include "protocol/sonar3d15/http.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

struct Sonar3d15Options {
  std::string head;                          ///< address of the head
  std::uint16_t port = 80;                   ///< of its HTTP interface
  Ipv4 interface = 0;                        ///< address that receives the images; 0: the system chooses
  std::vector<sonar3d15::Request> settings;  ///< sent in this order; the last switches acoustics on
  RunOptions run;
};

/// Declares and reads the options of the subcommand.
class Sonar3d15Arguments {
 public:
  /// Declares the options. `app` and this object must live until `app` has parsed.
  explicit Sonar3d15Arguments(CLI::App& app);

  /// @throws CLI::ValidationError
  Sonar3d15Options options() const;

 private:
  Sonar3d15Options options_;
  // As typed.
  RunArguments run_{700, 10.0};
  std::string interface_ = "0.0.0.0";
  std::string frequency_ = "low";
  double range_m_ = 15.0;
  double least_range_m_ = 0.3;
  double sound_speed_mps_ = 0.0;
};

/// A request that sets the resource at `path` below the integration interface.
sonar3d15::Request set(const std::string& path, std::string body);

}  // namespace sonard::client
