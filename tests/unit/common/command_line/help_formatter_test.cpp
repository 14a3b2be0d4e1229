// SPDX-License-Identifier: Apache-2.0
// How --help shows the values of options.
#include "common/command_line/help_formatter.hpp"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace sonard {
namespace {

/// The help of a program with an option for each kind of value that our programs take.
std::string help() {
  static std::string axes = "enu_flu", file;
  static int bits = 8, port = 0;
  static double rate_hz = 50.0, seconds = 0.0;
  static std::vector<int> ids{0};
  static bool loop = false;
  CLI::App app{"Test"};
  app.formatter(std::make_shared<HelpFormatter>());
  CLI::App* const sub = app.add_subcommand("sub", "Inherits the formatter");
  sub->add_option("--axes", axes, "A")->check(CLI::IsMember({"enu_flu", "ned_frd"}))->capture_default_str();
  sub->add_option("--bits", bits, "B")->check(CLI::IsMember({8, 16}))->capture_default_str();
  sub->add_option("--rate", rate_hz, "C")->check(CLI::Range(1e-3, 1e7))->capture_default_str();
  CLI::Option* const out = sub->add_option("--out", file, "D");
  sub->add_option("--port", port, "E")->check(CLI::Range(1, 65535))->needs(out);
  static int samples = 0;
  sub->add_option("--samples", samples, "I")
      ->check(CLI::Range(200, 1200) | CLI::IsMember({0}))
      ->capture_default_str();
  sub->add_option("--seconds", seconds, "F")->check(CLI::Range(0.0, 60.0));
  sub->add_option("--id", ids, "H")->delimiter(',')->capture_default_str();
  sub->add_flag("--loop", loop, "G");
  return sub->help();
}

TEST(HelpFormatter, PrintsNoTypeOrValidatorOfCli11) {
  const std::string text = help();
  for (const char* const raw : {"TEXT:", "INT:", "FLOAT", "UINT", " in [", "Needs", ":{"}) {
    EXPECT_EQ(text.find(raw), std::string::npos) << raw << "\n" << text;
  }
}

TEST(HelpFormatter, PrintsChoicesRangesAndDefaults) {
  const std::string text = help();
  for (const char* const wanted :
       {"--axes {enu_flu,ned_frd} [enu_flu]", "--bits {8,16} [8]", "--rate NUMBER [50]", "--port 1..65535",
        "--seconds 0..60", "--samples 200..1200 or 0 [0]", "--id NUMBER [0]"}) {
    EXPECT_NE(text.find(wanted), std::string::npos) << wanted << "\n" << text;
  }
}

}  // namespace
}  // namespace sonard
