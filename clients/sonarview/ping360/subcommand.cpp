// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/ping360/subcommand.hpp"

#include <memory>

#include "clients/sonarview/ping360/options.hpp"
#include "clients/sonarview/ping360/viewer.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary = "Client for a Ping360: scans, reports the rate, writes pictures.";

constexpr const char* footer = R"(Examples:
  sonarview ping360 --udp 127.0.0.1:12345 --range 10 --out out     all round, ping by ping, until Ctrl-C
  sonarview ping360 --udp 127.0.0.1:12345 --auto --turns 1         one turn, scanned by the head itself
  sonarview ping360 --tty /dev/ttyUSB0 --sector -45 45 --step 2    back and forth over 90 degrees ahead

Exit status: 0 pings arrived; 1 a file could not be written; 2 invalid command line; 3 no head;
4 the head refuses, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<Ping360Arguments>(app);
  return [arguments] { return [options = arguments->options()] { return view_ping360(options); }; };
}

}  // namespace

const Subcommand& ping360_subcommand() {
  static constexpr Subcommand subcommand{"ping360", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
