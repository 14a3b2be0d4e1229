// SPDX-License-Identifier: Apache-2.0
#include "server/offline/arguments.hpp"

#include <algorithm>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

namespace sonard::server {

OfflineArguments::OfflineArguments(CLI::App& app) {
  app.add_option("CONFIG", config_, "YAML file (docs/configuration.md)")->required();
  declare_run(app);
  declare_sonar(app);
}

void OfflineArguments::declare_run(CLI::App& app) {
  app.add_option("--trajectory", options_.trajectory, "Trajectory of the vehicle, CSV or TUM (docs/poses.md)")
      ->required();
  app.add_option("--out", options_.out, "Folder for all files; sonard does not render existing frames again")
      ->required();
  app.add_option("--body", bodies_,
                 "NAME=FILE: move a body of the world along this trajectory, CSV or TUM, on the clock of "
                 "--trajectory; repeat for each body")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--axes", axes_, "Convention for the axes of world, vehicle and bodies in the trajectories")
      ->check(CLI::IsMember({"enu_flu", "ned_frd"}))
      ->capture_default_str();
  app.add_option("--head", options_.head, "Name of a head in CONFIG; default: the first head");
  app.add_option("--rate", options_.rate_hz,
                 "Pings per second (lines, for scanning heads); default: the highest rate of the head")
      ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--seed", options_.seed,
                 "Seed of speckle, noise, clutter and element errors; give each trajectory of a data set its "
                 "own seed. Default: acoustics.seed of the head")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53));
  app.add_option("--element-seed", options_.element_seed,
                 "Seed of the element errors only; with a fixed value, each --seed gives different noise of "
                 "the same sonar. Default: acoustics.element_seed of the head, or --seed")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53));
  CLI::Option* const still =
      app.add_flag("--still", still_,
                   "Keep the sonar at rest during each ping; without --rate, render one frame for each pose "
                   "of the trajectory. Default: at rest if the trajectory moves as no vehicle can");
  app.add_flag("--no-still", never_still_, "Move the sonar along the trajectory during each ping")
      ->excludes(still);
  app.add_option(
      "--shard", shard_,
      "I/N: render share I of N, for N processes that fill one folder together; I starts at 0 or at 1");
  app.add_flag("--overwrite", options_.overwrite,
               "Render existing frames again, whatever their settings are");
  app.add_flag(
      "--truth", options_.truth,
      "Also write the body with the strongest echo in each bin; this renders an echo for each body nearby");
  app.add_flag("--clean-png", options_.clean_pictures,
               "Also write grey pictures without lettering, of the samples (_grey.png) and of the fan "
               "(_fan.png); with --truth also their masks. The JSON gives bearing and range of each pixel");
  app.add_flag("--mcap", options_.mcap, "Also write a log with topics for Foxglove (docs/logs.md)");
  app.add_option("--picture-every", options_.picture_every, "Write a picture every N frames; 0: no pictures")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--size", options_.radius_px, "Pixels in pictures from the apex to the full range")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
}

void OfflineArguments::declare_sonar(CLI::App& app) {
  const auto add = [&app](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->group("Sonar");
  };
  SurveyOptions& survey = options_.survey;
  add("--range", survey.range_m, "Range in metres; default: usual for the head");
  add("--gain", survey.gain_percent, "Gain in percent [50]")->check(CLI::Range(0.0, 100.0));
  add("--sound-speed", survey.sound_speed_mps,
      "Sound speed in metres per second, to convert times to ranges [1500]");
  add("--compression", survey.compression_log2,
      "Multibeam heads: 0..4: average 1, 2, 4, 8 or 16 range lines into one [0]")
      ->check(CLI::Range(0, 4));
  add("--bits", survey.bits, "Multibeam heads: bits per sample [8]")->check(CLI::IsMember({8, 16}));
  add("--frequency", survey.frequency, "Heads with two frequencies: low or high [low]")
      ->check(CLI::IsMember({"low", "high"}));
  add("--bins", survey.bins, "Scanning heads: bins per line")->check(CLI::Range(1, 65'535));
  add("--step", survey.step_deg, "Scanning heads: degrees from line to line [1.8]");
  add("--sector", survey.sector_deg,
      "Scanning heads: FROM TO, in degrees, clockwise; scan back and forth between them. Default: all round")
      ->expected(2)
      ->check(CLI::Range(-360.0, 360.0));
}

OfflineOptions OfflineArguments::options() const {
  OfflineOptions options = options_;
  options.axes = axes_ == "ned_frd" ? pose::Axes::ned_frd : pose::Axes::enu_flu;
  const std::optional<Shard> shard = parse_shard(shard_);
  if (!shard) {
    throw CLI::ValidationError("--shard",
                               fmt::format("expected I/N with 0 <= I <= N and N >= 1, found '{}'", shard_));
  }
  options.shard = *shard;
  if (still_ || never_still_) {
    options.still = still_;
  }
  for (const std::string& body : bodies_) {
    const std::size_t equals = body.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == body.size()) {
      throw CLI::ValidationError("--body", fmt::format("expected NAME=FILE, found '{}'", body));
    }
    const std::string name = body.substr(0, equals);
    if (std::ranges::find(options.bodies, name, &OfflineOptions::BodyWay::body) != options.bodies.end()) {
      throw CLI::ValidationError("--body", fmt::format("'{}' is given twice (expected once per body)", name));
    }
    options.bodies.push_back({name, body.substr(equals + 1)});
  }
  return options;
}

}  // namespace sonard::server
