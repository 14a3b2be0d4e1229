#include "server/offline/arguments.hpp"

#include <string>
#include <variant>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "protocol/micron/bins.hpp"

namespace sonard::server {
namespace {

constexpr int most_ad_interval = 65'535;

template <class Value>
void take(const std::optional<Value>& typed, Value& setting) {
  setting = typed.value_or(setting);
}

void require_range(const char* option, const std::optional<double>& value, double least, double most,
                   const char* head) {
  if (value && !(*value >= least && *value <= most)) {
    throw CLI::ValidationError(
        option, fmt::format("{} is out of range for a {} (expected {} to {})", *value, head, least, most));
  }
}

void refuse(const char* option, bool typed, const char* head) {
  if (typed) {
    throw CLI::ValidationError(option, fmt::format("means nothing to a {}", head));
  }
}

/// Null where there is none of this name; who asks for one that is not there is told when it is rendered.
const AnyHeadConfig* head_named(const std::vector<AnyHeadConfig>& heads, const std::string& name) {
  for (const AnyHeadConfig& head : heads) {
    if (name.empty() || common(head).name == name) {
      return &head;
    }
  }
  return nullptr;
}

}  // namespace

OfflineArguments::OfflineArguments(CLI::App& app) {
  app.add_option("CONFIG", config_, "YAML file (docs/configuration.md)")->required();
  declare_run(app);
  declare_sonar(app);
}

void OfflineArguments::declare_run(CLI::App& app) {
  app.add_option("--trajectory", options_.trajectory, "Way of the vehicle, CSV or TUM (docs/poses.md)")
      ->required();
  app.add_option("--out", options_.out, "Folder for all files; frames that are there are not made again")
      ->required();
  app.add_option("--axes", axes_, "Axes of world and vehicle in the trajectory")
      ->check(CLI::IsMember({"enu_flu", "ned_frd"}))
      ->capture_default_str();
  app.add_option("--head", options_.head, "Name of a head in CONFIG; without it the first");
  app.add_option("--rate", options_.rate_hz,
                 "Pings a second (lines, of a Micron); without it as many as the head can")
      ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--shard", shard_,
                 "I/N: one of N processes, that render into one folder together what one would alone; I "
                 "counts from 0 or from 1");
  app.add_flag("--overwrite", options_.overwrite,
               "Make frames that are there again, whatever they were made with");
  app.add_flag("--truth", options_.truth,
               "Also which body is heard in each bin; takes an echo for each body near");
  app.add_option("--size", options_.radius_px, "Pixels of pictures from the apex to the full range")
      ->check(CLI::Range(64, 8192))
      ->capture_default_str();
}

void OfflineArguments::declare_sonar(CLI::App& app) {
  const auto add = [&app](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->group("Sonar");
  };
  add("--range", range_m_, "Metres [Gemini: 20, Micron: 10]");
  add("--gain", gain_percent_, "Percent [50]")->check(CLI::Range(0.0, 100.0));
  add("--sound-speed", sound_speed_mps_, "Metres per second, in which ranges are counted [1500]");
  add("--compression", compression_, "Gemini: 0..4: average 1, 2, 4, 8 or 16 range lines into one [0]")
      ->check(CLI::Range(0, 4));
  add("--bits", bits_, "Gemini: bits of a sample [8]")->check(CLI::IsMember({8, 16}));
  add("--bins", bins_, "Micron: bins of a line [400]")->check(CLI::Range(1, micron::max_bins));
  add("--step", step_deg_, "Micron: degrees from line to line, a multiple of 0.05625 [1.8]");
  add("--sector", sector_deg_, "Micron: FROM TO, degrees, clockwise; to and fro between them. Else all round")
      ->expected(2)
      ->check(CLI::Range(-360.0, 360.0));
}

OfflineOptions OfflineArguments::options(const std::vector<AnyHeadConfig>& heads) const {
  OfflineOptions options = options_;
  options.axes = axes_ == "ned_frd" ? pose::Axes::ned_frd : pose::Axes::enu_flu;
  const std::optional<Shard> shard = parse_shard(shard_);
  if (!shard) {
    throw CLI::ValidationError("--shard",
                               fmt::format("expected I/N with 0 <= I <= N and N >= 1, found '{}'", shard_));
  }
  options.shard = *shard;
  if (const AnyHeadConfig* head = head_named(heads, options.head)) {
    if (std::holds_alternative<GeminiHeadConfig>(*head)) {
      set_gemini(options.gemini);
    } else {
      set_micron(options.micron);
    }
  }
  return options;
}

void OfflineArguments::set_gemini(gemini::PingSettings& settings) const {
  constexpr const char* head = "Gemini";
  refuse("--bins", bins_.has_value(), head);
  refuse("--step", step_deg_.has_value(), head);
  refuse("--sector", !sector_deg_.empty(), head);
  require_range("--range", range_m_, 0.3, 150.0, head);
  require_range("--sound-speed", sound_speed_mps_, 1400.0, 1588.0, head);
  take(range_m_, settings.range_m);
  take(gain_percent_, settings.gain_percent);
  take(sound_speed_mps_, settings.sound_speed_mps);
  take(compression_, settings.compression_log2);
  settings.sixteen_bit = bits_ == 16;
}

void OfflineArguments::set_micron(micron::ScanSettings& settings) const {
  constexpr const char* head = "Micron";
  refuse("--compression", compression_.has_value(), head);
  refuse("--bits", bits_.has_value(), head);
  require_range("--range", range_m_, 0.1, 200.0, head);
  require_range("--sound-speed", sound_speed_mps_, 1300.0, 1700.0, head);
  take(range_m_, settings.range_m);
  take(gain_percent_, settings.gain_percent);
  take(sound_speed_mps_, settings.sound_speed_mps);
  take(bins_, settings.bins);
  if (step_deg_) {
    const std::optional<int> step = micron::step_of_degrees(*step_deg_);
    if (!step) {
      throw CLI::ValidationError(
          "--step",
          fmt::format("expected a multiple of {} degrees, {} at most, found {}", micron::step_unit_deg,
                      micron::most_step * micron::step_unit_deg, *step_deg_));
    }
    settings.step = *step;
  }
  if (!sector_deg_.empty()) {
    settings.sector = {micron::bearing_of_degrees(sector_deg_[0]),
                       micron::bearing_of_degrees(sector_deg_[1])};
    if (settings.sector->left == settings.sector->right) {
      throw CLI::ValidationError("--sector", "FROM and TO are one bearing; leave it away to scan all round");
    }
  }
  if (const int interval = micron::ad_interval(settings); interval < 1 || interval > most_ad_interval) {
    throw CLI::ValidationError("--bins", fmt::format("{} bins over {} m are too {} for a head", settings.bins,
                                                     settings.range_m, interval < 1 ? "fine" : "coarse"));
  }
}

}  // namespace sonard::server
