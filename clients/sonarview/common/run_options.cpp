// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/common/run_options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace sonard::client {
namespace {

std::chrono::nanoseconds to_ns(double seconds) {
  return std::chrono::nanoseconds{std::llround(seconds * 1e9)};
}

}  // namespace

void RunArguments::declare(CLI::App& app, const RunWords& words) {
  const auto add = [&](const std::string& name, auto& value, const std::string& what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Run");
  };
  const std::string ping = words.ping;
  add("--wait", wait_s_, words.wait)->check(CLI::Range(0.1, 1e6))->group(words.link_group);
  add("--" + ping + "-wait", ping_wait_s_, fmt::format("Seconds to wait for the next {}; 0: no limit", ping))
      ->check(CLI::Range(0.0, 1e6))
      ->group(words.link_group);
  add("--" + ping + "s", options_.pings, fmt::format("End after this many {}s; 0: no limit", ping))
      ->check(CLI::Range(0, 1'000'000'000));
  add("--seconds", seconds_, "End this many seconds after the head's first message; 0: no limit")
      ->check(CLI::Range(0.0, 1e9));
  CLI::Option* const out =
      app.add_option("--out", options_.out, "Folder for pictures: the scene in colour, the samples in grey")
          ->group("Run");
  add("--every", options_.every, fmt::format("Write a picture every N {}s; 0: only the last", words.picture))
      ->check(CLI::Range(0, 1'000'000'000))
      ->needs(out);
  add("--size", options_.radius_px, "Pixels in pictures from the apex to the full range")
      ->check(CLI::Range(64, 8192));
  app.add_flag("--log-" + ping + "s", options_.log_pings,
               fmt::format("Print a line of key=value for each {} on standard output", ping))
      ->group("Run");
  app.add_flag("--quiet", options_.quiet, "Print no progress on standard error")->group("Run");
}

RunOptions RunArguments::options() const {
  RunOptions options = options_;
  options.duration = to_ns(seconds_);
  options.wait = to_ns(wait_s_);
  options.ping_wait = to_ns(ping_wait_s_);
  return options;
}

}  // namespace sonard::client
