// SPDX-License-Identifier: Apache-2.0
#include "server/devices/oculus/survey.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include <CLI/Error.hpp>
#include <nlohmann/json.hpp>

#include "protocol/oculus/ping_plan.hpp"
#include "server/devices/oculus/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

/// Uses 512 beams and linear samples, like other heads.
oculus::SimpleFire fire_of(const SurveyOptions& options, const oculus::Model& model) {
  const OptionsOf taken("Oculus");
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bins", options.bins.has_value());
  taken.refuse("--step", options.step_deg.has_value());
  taken.refuse("--sector", !options.sector_deg.empty());
  oculus::SimpleFire fire;
  const bool high = options.frequency == "high";
  if (high && !model.has_high_frequency()) {
    throw CLI::ValidationError("--frequency", "this Oculus has one frequency");
  }
  const oculus::Mode& mode = model.modes[high ? 1 : 0];
  fire.fire.master_mode = high ? 2 : 1;
  fire.fire.ping_rate = 2;
  fire.fire.gamma = 255;
  fire.fire.flags =
      oculus::fire_flags::range_in_metres | oculus::fire_flags::simple_result | oculus::fire_flags::beams_512;
  fire.fire.range = std::min(20.0, mode.most_range_m);
  fire.fire.sound_speed_mps = 1500.0;
  taken.take("--range", options.range_m, oculus::least_range_m, mode.most_range_m, fire.fire.range);
  taken.take("--gain", options.gain_percent, 0.0, 100.0, fire.fire.gain_percent);
  taken.take("--sound-speed", options.sound_speed_mps, 1400.0, 1600.0, fire.fire.sound_speed_mps);
  if (options.bits == 16) {
    fire.fire.flags |= oculus::fire_flags::sixteen_bit;
  }
  return fire;
}

class OculusSurvey final : public Survey {
 public:
  OculusSurvey(const HeadConfig& head, const SurveyOptions& options)
      : config_(device_settings<OculusConfig>(head).device.plan),
        plan_(oculus::plan_ping(fire_of(options, config_.model), config_)) {}

  std::chrono::nanoseconds natural_period() const override { return plan_.period; }

  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings(static_cast<std::size_t>(pings) + 1);
    std::iota(first_pings.begin(), first_pings.end(), 0);
    return first_pings;
  }

  PingJob job(int ping) const override {
    PingJob job = oculus::job_of(plan_, config_);
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  double client_bin_m() const override { return plan_.result.range_resolution_m; }
  std::vector<double> bearings_rad() const override {
    std::vector<double> bearings;
    std::ranges::transform(plan_.result.bearings_cdeg, std::back_inserter(bearings),
                           [](std::int16_t cdeg) { return cdeg * std::numbers::pi / 18000.0; });
    return bearings;
  }

  nlohmann::ordered_json settings_json() const override {
    const oculus::Fire& fire = plan_.asked.fire;
    return {{"range_m", fire.range},
            {"gain_percent", fire.gain_percent},
            {"sound_speed_mps", fire.sound_speed_mps},
            {"frequency_hz", plan_.result.frequency_hz},
            {"beams", plan_.result.beams},
            {"bits", plan_.result.data_size == oculus::DataSize::bits_8 ? 8 : 16},
            {"bins", plan_.result.ranges}};
  }

  PingRecord record(int ping, std::vector<std::uint8_t> samples) const override {
    PingRecord record = Survey::record(ping, std::move(samples));
    record.settings.frequency_hz = plan_.result.frequency_hz;
    return record;
  }

 private:
  oculus::PlanConfig config_;
  oculus::PingPlan plan_;
};

}  // namespace

std::unique_ptr<Survey> survey_of_oculus(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<OculusSurvey>(head, options);
}

}  // namespace sonard::server
