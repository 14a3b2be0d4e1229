// SPDX-License-Identifier: Apache-2.0
#include "server/devices/micron/survey.hpp"

#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocol/micron/line_job.hpp"
#include "protocol/micron/line_timing.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "protocol/micron/scan_settings.hpp"
#include "protocol/micron/sweep.hpp"
#include "protocol/micron/units.hpp"
#include "server/devices/micron/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

constexpr int most_ad_interval = 65'535;
constexpr double unit_rad = 2.0 * std::numbers::pi / micron::units_per_turn;

micron::ScanSettings scan_settings(const SurveyOptions& options) {
  const OptionsOf taken("Micron");
  taken.refuse("--frequency", options.frequency.has_value());
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bits", options.bits.has_value());
  micron::ScanSettings settings;
  taken.take("--range", options.range_m, 0.1, 200.0, settings.range_m);
  taken.take("--gain", options.gain_percent, 0.0, 100.0, settings.gain_percent);
  taken.take("--sound-speed", options.sound_speed_mps, 1300.0, 1700.0, settings.sound_speed_mps);
  settings.bins = options.bins.value_or(settings.bins);
  if (settings.bins > micron::max_bins) {
    throw CLI::ValidationError("--bins", fmt::format("{} is out of range for Micron (expected 1 to {})",
                                                     settings.bins, micron::max_bins));
  }
  if (options.step_deg) {
    const std::optional<int> step = micron::step_of_degrees(*options.step_deg);
    if (!step) {
      throw CLI::ValidationError(
          "--step",
          fmt::format("expected a multiple of {} degrees, {} at most, found {}", micron::step_unit_deg,
                      micron::most_step * micron::step_unit_deg, *options.step_deg));
    }
    settings.step = *step;
  }
  if (!options.sector_deg.empty()) {
    settings.sector = {micron::bearing_of_degrees(options.sector_deg[0]),
                       micron::bearing_of_degrees(options.sector_deg[1])};
    if (settings.sector->left == settings.sector->right) {
      throw CLI::ValidationError("--sector", "FROM and TO are equal; omit --sector to scan all round");
    }
  }
  if (const int interval = micron::ad_interval(settings); interval < 1 || interval > most_ad_interval) {
    throw CLI::ValidationError("--bins", fmt::format("{} bins over {} m are too {} for a head", settings.bins,
                                                     settings.range_m, interval < 1 ? "fine" : "coarse"));
  }
  return settings;
}

/// First bearing of a scan: ahead, or the limit that it turns away from.
int first_bearing(const micron::ScanSettings& settings) {
  if (!settings.sector) {
    return micron::bearing_ahead;
  }
  return settings.clockwise ? settings.sector->left : settings.sector->right;
}

class MicronSurvey final : public Survey {
 public:
  MicronSurvey(const HeadConfig& head, const SurveyOptions& options)
      : config_(device_settings<MicronConfig>(head)),
        asked_(scan_settings(options)),
        command_(make_head_command(asked_)) {}

  std::chrono::nanoseconds natural_period() const override {
    const micron::DeviceConfig& device = config_.device;
    return device.line_period.value_or(micron::line_timing(command_, device, command_.step).period(device));
  }

  PingJob job(int ping) const override {
    PingJob job =
        micron::make_line_job(command_, config_.device, bearings_.at(static_cast<std::size_t>(ping)));
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  // A turn ends before its first bearing comes again; a sweep of a sector ends with the line at the other
  // limit.
  std::vector<int> frames(int pings) override {
    micron::Sweep sweep(config_.device.limits_order);
    sweep.configure(command_, first_bearing(asked_));
    int turned = 0;
    std::vector<int> first_pings{0};
    bearings_.clear();
    for (int ping = 0; ping < pings; ++ping) {
      bearings_.push_back(sweep.bearing());
      const bool at_limit = ping > 0 && sweep.code() != micron::SweepCode::normal;
      turned += sweep.step();
      if (asked_.sector ? at_limit : turned >= micron::units_per_turn) {
        first_pings.push_back(ping + 1);
        turned -= micron::units_per_turn;
      }
    }
    return first_pings;
  }

  double client_bin_m() const override { return micron::bin_length_m(asked_); }

  Sector sector() const override {
    Sector sector{-std::numbers::pi, 2.0 * std::numbers::pi, asked_.step * unit_rad};
    if (asked_.sector) {
      // If the client does not set the invert bit, a boot-down head looks to the opposite side.
      const bool mirrored = config_.device.mounted_inverted;
      sector.left_rad =
          mirrored ? -micron::bearing_rad(asked_.sector->right) : micron::bearing_rad(asked_.sector->left);
      sector.width_rad = micron::wrapped(asked_.sector->right - asked_.sector->left) * unit_rad;
    }
    return sector;
  }

  nlohmann::ordered_json settings_json() const override {
    nlohmann::ordered_json sector;
    if (asked_.sector) {
      sector = {micron::bearing_deg(asked_.sector->left), micron::bearing_deg(asked_.sector->right)};
    }
    return {{"range_m", asked_.range_m},
            {"gain_percent", asked_.gain_percent},
            {"sound_speed_mps", asked_.sound_speed_mps},
            {"bins", asked_.bins},
            {"step_deg", asked_.step * micron::step_unit_deg},
            {"sector_deg", sector}};
  }

  PingRecord record(int ping, std::vector<std::uint8_t> samples) const override {
    PingRecord record = Survey::record(ping, std::move(samples));
    record.settings.frequency_hz = micron::carrier_hz;
    return record;
  }

 private:
  MicronConfig config_;
  micron::ScanSettings asked_;
  micron::HeadCommand command_;
  std::vector<int> bearings_;  ///< of every ping planned by frames(), in units
};

}  // namespace

std::unique_ptr<Survey> survey_of_micron(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<MicronSurvey>(head, options);
}

}  // namespace sonard::server
