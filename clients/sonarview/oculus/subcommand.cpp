// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/oculus/subcommand.hpp"

#include <memory>

#include "clients/sonarview/oculus/options.hpp"
#include "clients/sonarview/oculus/viewer.hpp"

namespace sonard::client {
namespace {

constexpr const char* summary = "Client for an Oculus: pings, reports the rate, writes pictures.";

constexpr const char* footer = R"(Examples:
  sonarview oculus --out out                              the head whose status packet arrives first, until Ctrl-C
  sonarview oculus --head 127.0.0.3 --pings 10 --bits 16  ten pings of 512 beams
  sonarview oculus --frequency high --range 5 --rate 40   the narrow fan, as fast as the head can

Exit status: 0 pings arrived, and no ping was missed; 1 a socket or a file could not be opened or written;
2 invalid command line; 3 no head; 4 pings were missed, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<OculusArguments>(app);
  return [arguments] { return [options = arguments->options()] { return view_oculus(options); }; };
}

}  // namespace

const Subcommand& oculus_subcommand() {
  static constexpr Subcommand subcommand{"oculus", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
