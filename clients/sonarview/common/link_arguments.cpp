// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/link_arguments.hpp"

#include <CLI/CLI.hpp>
#include <boost/asio/ip/address_v4.hpp>

namespace sonard::client {
namespace {

LineAddress host_and_port(LineAddress::Way way, const std::string& option, const std::string& text) {
  const auto parsed = parse_host_and_port(text);
  if (!parsed) {
    throw CLI::ValidationError(option, "expected HOST:PORT, found '" + text + "'");
  }
  return {.way = way, .place = parsed->host, .port = parsed->port};
}

}  // namespace

Ipv4 ipv4_argument(const std::string& option, const std::string& text) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address_v4(text, error);
  if (error) {
    throw CLI::ValidationError(option, "expected an IPv4 address, found '" + text + "'");
  }
  return address.to_uint();
}

void LinkArguments::declare(CLI::App& app) {
  CLI::Option* tcp = app.add_option("--tcp", tcp_, "HOST:PORT of a serial device server, or of sonard");
  CLI::Option* udp = app.add_option("--udp", udp_, "HOST:PORT, for datagrams instead of a connection");
  CLI::Option* tty = app.add_option("--tty", tty_, "Serial device or pseudo terminal");
  tcp->excludes(udp)->excludes(tty)->group(group);
  udp->excludes(tty)->group(group);
  tty->group(group);
  app.add_option("--baud", baud_, "Bits per second of the serial device, 8N1")
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
  throw CLI::ValidationError("--tcp, --udp, --tty", "one of them is required, with the address of the head");
}

}  // namespace sonard::client
