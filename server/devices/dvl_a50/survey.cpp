// SPDX-License-Identifier: Apache-2.0
#include "server/devices/dvl_a50/survey.hpp"

#include <numbers>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "protocol/dvl_a50/measurement.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "server/devices/dvl_a50/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

dvl_a50::DeviceConfig with_options(dvl_a50::DeviceConfig device, const SurveyOptions& options) {
  const OptionsOf taken("DVL");
  taken.refuse("--range", options.range_m.has_value());
  taken.refuse("--gain", options.gain_percent.has_value());
  taken.refuse("--frequency", options.frequency.has_value());
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bits", options.bits.has_value());
  taken.refuse("--bins", options.bins.has_value());
  taken.refuse("--step", options.step_deg.has_value());
  taken.refuse("--sector", !options.sector_deg.empty());
  taken.take("--sound-speed", options.sound_speed_mps, 1000.0, 2000.0, device.settings.speed_of_sound_mps);
  device.beam_noise_mps = device.beam_noise_factor = 0.0;
  return device;
}

class DvlSurvey final : public Survey {
 public:
  DvlSurvey(const HeadConfig& head, const SurveyOptions& options)
      : device_(with_options(device_settings<DvlConfig>(head).device, options)),
        plan_(dvl_a50::plan_ping(std::nullopt, device_, device_.settings)) {}

  std::chrono::nanoseconds natural_period() const override { return dvl_a50::ping_period(plan_, device_); }

  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings(static_cast<std::size_t>(pings) + 1);
    std::iota(first_pings.begin(), first_pings.end(), 0);
    return first_pings;
  }

  PingJob job(int ping) const override {
    PingJob job = dvl_a50::make_job(plan_, device_);
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  double client_bin_m() const override {
    return device_.settings.speed_of_sound_mps / device_.distance_steps_hz;
  }
  Sector sector() const override { return {0.0, 2.0 * std::numbers::pi, 2.0 * std::numbers::pi / 180.0}; }

  nlohmann::ordered_json settings_json() const override {
    return {{"range_m", plan_.range_m}, {"sound_speed_mps", device_.settings.speed_of_sound_mps}};
  }

  /// The echoes of the beams alone.
  DirectionRanges measured(const DirectionRanges& echoes) const override {
    DirectionRanges sent = echoes;
    for (int row = 0; row < sent.rows; ++row) {
      for (int column = 0; column < sent.columns; ++column) {
        const bool corner = (row == 0 || row == sent.rows - 1) && (column == 0 || column == sent.columns - 1);
        const auto pixel = static_cast<std::size_t>(row * sent.columns + column);
        sent.range_m[pixel] = corner ? sent.range_m[pixel] : 0.0F;
        sent.intensity[pixel] = corner ? sent.intensity[pixel] : 0.0F;
      }
    }
    return sent;
  }

  PingRecord record_of_measured(int ping, const DirectionRanges& sent, std::int64_t unix_ns) const override {
    dvl_a50::Noise noise(device_.seed);
    const auto ranges_m = dvl_a50::beam_ranges_m(sent).value_or(std::array<double, 4>{});
    dvl_a50::Velocity report = dvl_a50::measure(ranges_m, {}, plan_, device_, device_.settings, noise).report;
    report.validity_us = report.transmission_us = unix_ns / 1000;
    PingRecord record = dvl_a50::record_of(report, plan_.range_m, device_.water_sound_speed_mps);
    record.number = static_cast<std::uint64_t>(ping);
    return record;
  }

 private:
  dvl_a50::DeviceConfig device_;
  dvl_a50::PingPlan plan_;
};

}  // namespace

std::unique_ptr<Survey> survey_of_dvl(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<DvlSurvey>(head, options);
}

}  // namespace sonard::server
