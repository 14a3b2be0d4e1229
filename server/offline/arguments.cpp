// SPDX-License-Identifier: Apache-2.0
#include "server/offline/arguments.hpp"

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
  app.add_option("--out", options_.out, "Folder for all files; existing frames are not rendered again")
      ->required();
  app.add_option("--body", bodies_,
                 "NAME=FILE: a body of the world moves along this trajectory, CSV or TUM, on the clock of "
                 "--trajectory; once for each body")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--axes", axes_, "Axes of world, vehicle and bodies in the trajectories")
      ->check(CLI::IsMember({"enu_flu", "ned_frd"}))
      ->capture_default_str();
  app.add_option("--head", options_.head, "Name of a head in CONFIG; default: the first");
  app.add_option("--rate", options_.rate_hz,
                 "Pings per second (lines of a scanning head); default: as many as the head can")
      ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--seed", options_.seed,
                 "Of speckle, noise, clutter and element errors: another for each trajectory of a data set; "
                 "default: acoustics.seed of the head")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53));
  app.add_option("--element-seed", options_.element_seed,
                 "Of element errors alone: with a fixed value, --seed gives other noise of the same sonar; "
                 "default: acoustics.element_seed of the head, or as --seed")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1} << 53));
  CLI::Option* const still = app.add_flag("--still", still_,
                                          "The sonar is at rest in each ping; without --rate, one frame for "
                                          "each pose of the trajectory. Default: "
                                          "at rest where the trajectory moves as no vehicle does");
  app.add_flag("--no-still", never_still_, "The sonar moves in each ping as the trajectory does")
      ->excludes(still);
  app.add_option(
      "--shard", shard_,
      "I/N: render share I of N, for N processes that fill one folder together; I counts from 0 or "
      "from 1");
  app.add_flag("--overwrite", options_.overwrite, "Render existing frames again, whatever their settings");
  app.add_flag("--truth", options_.truth,
               "Also write which body echoes most in each bin; renders an echo for each body near");
  app.add_flag(
      "--clean-png", options_.clean_pictures,
      "Also write grey pictures without labels, of the samples (_grey.png) and of the fan (_fan.png); "
      "with --truth also their masks. The JSON says bearing and range of each pixel");
  app.add_flag("--mcap", options_.mcap, "Also write a log with topics for Foxglove (docs/logs.md)");
  app.add_option("--picture-every", options_.picture_every, "A picture of every so-many-th frame; 0: none")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--size", options_.radius_px, "Pixels of pictures from the apex to the full range")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
}

void OfflineArguments::declare_sonar(CLI::App& app) {
  const auto add = [&app](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->group("Sonar");
  };
  SurveyOptions& survey = options_.survey;
  add("--range", survey.range_m, "Metres; default: usual for the head");
  add("--gain", survey.gain_percent, "Percent [50]")->check(CLI::Range(0.0, 100.0));
  add("--sound-speed", survey.sound_speed_mps, "Metres per second, for converting times to ranges [1500]");
  add("--compression", survey.compression_log2,
      "Multibeam: 0..4: average 1, 2, 4, 8 or 16 range lines into one [0]")
      ->check(CLI::Range(0, 4));
  add("--bits", survey.bits, "Multibeam: bits of a sample [8]")->check(CLI::IsMember({8, 16}));
  add("--frequency", survey.frequency, "Heads with two frequencies: low or high [low]")
      ->check(CLI::IsMember({"low", "high"}));
  add("--bins", survey.bins, "Scanning: bins of a line")->check(CLI::Range(1, 65'535));
  add("--step", survey.step_deg, "Scanning: degrees from line to line [1.8]");
  add("--sector", survey.sector_deg,
      "Scanning: FROM TO, degrees, clockwise; back and forth between them. Default: all round")
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
    options.bodies.push_back({body.substr(0, equals), body.substr(equals + 1)});
  }
  return options;
}

}  // namespace sonard::server
