// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/subcommand.hpp"

#include <memory>

#include "clients/sonarview/gemini/options.hpp"
#include "clients/sonarview/gemini/viewer.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary =
    "Client for a Gemini 720i that acts as a vehicle: pings, repairs losses, reports rate and loss, writes "
    "pictures.";

constexpr const char* footer = R"(Examples:
  sonarview --range 20 --compression 1 --out out          the head of configs/demo.yaml, until Ctrl-C
  sonarview --continuous 100 --pings 200 --log-pings      a ping every 100 ms, one line per ping
  sonarview --drop-rx 0.05 --drop-tx 0.05 --pings 200     a link that loses 5 % in both directions
  sonarview --client-address 10.61.19.1                  a head on another network

Exit status: 0 all pings complete; 1 a socket or file could not be opened; 2 invalid command line;
3 no head; 4 a ping was incomplete, or no ping arrived.)";

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
