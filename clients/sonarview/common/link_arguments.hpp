// SPDX-License-Identifier: Apache-2.0
// The options for the serial line, or its device server, that leads to a head.
#pragma once

#include <string>

#include "clients/sonarview/common/serial_line.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

/// --tcp, --udp, --tty and --baud.
class LinkArguments {
 public:
  static constexpr const char* group = "Link (one of --tcp, --udp, --tty)";

  /// Declares the options. `app` and this object must live until `app` has parsed.
  void declare(CLI::App& app);
  /// @throws CLI::ValidationError
  LineAddress address() const;

 private:
  // As typed.
  std::string tcp_;
  std::string udp_;
  std::string tty_;
  unsigned baud_ = 115'200;
};

}  // namespace sonard::client
