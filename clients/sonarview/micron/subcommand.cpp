// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/micron/subcommand.hpp"

#include <memory>

#include "clients/sonarview/micron/options.hpp"
#include "clients/sonarview/micron/viewer.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary =
    "Client for a Micron: scans, reports rate and loss, writes pictures and lines.";

constexpr const char* footer = R"(Examples:
  sonarview micron --tcp 127.0.0.1:4001 --range 20 --out out       all round, until Ctrl-C
  sonarview micron --tty /dev/ttyUSB0 --turns 1 --raw sweep.jsonl   one sweep, with its lines in a file
  sonarview micron --tcp 10.0.0.7:4001 --sector -45 45 --step 0.9  back and forth over 90 degrees ahead

Exit status: 0 all lines arrived; 1 a file could not be written; 2 invalid command line; 3 no head;
4 lines are missing, or no line arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<MicronArguments>(app);
  return [arguments] { return [options = arguments->options()] { return view_micron(options); }; };
}

}  // namespace

const Subcommand& micron_subcommand() {
  static constexpr Subcommand subcommand{"micron", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
