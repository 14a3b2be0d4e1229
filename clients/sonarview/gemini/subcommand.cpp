// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/subcommand.hpp"

#include <memory>

#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/viewer.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary =
    "Talks to a Gemini 720i as a vehicle would: pings, repairs losses, reports rate and loss, writes "
    "pictures.";

constexpr const char* footer = R"(Examples:
  sonarview --range 20 --compression 1 --out out          to the head of configs/demo.yaml, until Ctrl-C
  sonarview --continuous 100 --pings 200 --log-pings      pings every 100 ms, one line each
  sonarview --drop-rx 0.05 --drop-tx 0.05 --pings 200     on a link that loses 5 % both ways
  sonarview --surface-address 10.61.19.1                  to a head on another network
  sonarview compare --help                                images against each other

Exit status: 0 all pings complete; 1 a socket or file could not be opened; 2 command line; 3 no head;
4 a ping ended incomplete, or none came.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<GeminiArguments>(app);
  return [arguments] { return [options = arguments->options()] { return view_gemini(options); }; };
}

}  // namespace

const Subcommand& gemini_subcommand() {
  static constexpr Subcommand subcommand{"gemini", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
