// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/link_arguments.hpp"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <system_error>

namespace sonard::client {
namespace {

LineAddress host_and_port(LineAddress::Way way, const std::string& option, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  unsigned port = 0;
  if (colon != std::string::npos && colon > 0) {
    const char* end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data() + colon + 1, end, port);
    port = error == std::errc() && rest == end && port <= 65'535 ? port : 0;
  }
  if (port == 0) {
    throw CLI::ValidationError(option, "expected HOST:PORT, found '" + text + "'");
  }
  return {.way = way, .place = text.substr(0, colon), .port = static_cast<std::uint16_t>(port)};
}

}  // namespace

void LinkArguments::declare(CLI::App& app) {
  CLI::Option* tcp = app.add_option("--tcp", tcp_, "HOST:PORT of a serial device server, or of sonard");
  CLI::Option* udp = app.add_option("--udp", udp_, "HOST:PORT, datagrams instead of a connection");
  CLI::Option* tty = app.add_option("--tty", tty_, "Serial device or pseudo terminal");
  tcp->excludes(udp)->excludes(tty)->group(group);
  udp->excludes(tty)->group(group);
  tty->group(group);
  app.add_option("--baud", baud_, "Bits per second of a serial device, 8N1")
      ->needs(tty)
      ->capture_default_str()
      ->group(group);
}

LineAddress LinkArguments::address() const {
  if (!tcp_.empty()) {
    return host_and_port(LineAddress::Way::tcp, "--tcp", tcp_);
  }
  if (!udp_.empty()) {
    return host_and_port(LineAddress::Way::udp, "--udp", udp_);
  }
  if (!tty_.empty()) {
    return {.way = LineAddress::Way::tty, .place = tty_, .baud = baud_};
  }
  throw CLI::ValidationError("--tcp, --udp, --tty", "one of them must say where the head is");
}

}  // namespace sonard::client
