// SPDX-License-Identifier: Apache-2.0
// The options for the address of a head.
#pragma once

#include <string>

#include "clients/sonarview/common/serial_line.hpp"
#include "protocol/common/endpoint.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): not ours
class App;
}

namespace sonard::client {

/// Reads the value of `option`. @throws CLI::ValidationError
Ipv4 ipv4_argument(const std::string& option, const std::string& text);

/// --tcp, --udp, --tty and --baud: the serial line, or its device server, that leads to a head.
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
