// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping1d/survey.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "protocol/ping1d/echo.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "protocol/ping1d/scan.hpp"
#include "server/devices/ping1d/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

ping1d::Scan asked_of(const SurveyOptions& options) {
  const OptionsOf taken("Ping1D");
  taken.refuse("--frequency", options.frequency.has_value());
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bits", options.bits.has_value());
  taken.refuse("--bins", options.bins.has_value());
  taken.refuse("--step", options.step_deg.has_value());
  taken.refuse("--sector", !options.sector_deg.empty());
  double range_m = 1e-3 * ping1d::usual_scan.length_mm;
  double gain_percent = 100.0 * ping1d::usual_scan.gain / ping1d::most_gain;
  double sound_speed_mps = ping1d::usual_scan.sound_speed_mps();
  taken.take("--range", options.range_m, 1.0, 100.0, range_m);
  taken.take("--gain", options.gain_percent, 0.0, 100.0, gain_percent);
  taken.take("--sound-speed", options.sound_speed_mps, 1300.0, 1700.0, sound_speed_mps);
  return {.length_mm = static_cast<std::uint32_t>(std::lround(1e3 * range_m)),
          .gain = static_cast<std::uint8_t>(std::lround(gain_percent / 100.0 * ping1d::most_gain)),
          .speed_of_sound_mmps = static_cast<std::uint32_t>(std::lround(1e3 * sound_speed_mps))};
}

class Ping1dSurvey final : public Survey {
 public:
  Ping1dSurvey(const HeadConfig& head, const SurveyOptions& options)
      : device_(device_settings<Ping1dConfig>(head).device), scan_(asked_of(options)) {}

  std::chrono::nanoseconds natural_period() const override {
    return ping1d::ping_period(scan_, device_.interval_ms, device_);
  }

  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings(static_cast<std::size_t>(pings) + 1);
    std::iota(first_pings.begin(), first_pings.end(), 0);
    return first_pings;
  }

  PingJob job(int ping) const override {
    PingJob job = ping1d::make_job(scan_, device_);
    job.sixteen_bit = false;
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  double client_bin_m() const override { return 1e-3 * ping1d::samples_of(scan_, device_.points).step_mm; }
  Sector sector() const override { return {0.0, 2.0 * std::numbers::pi, 2.0 * std::numbers::pi / 180.0}; }

  nlohmann::ordered_json settings_json() const override {
    return {{"range_m", 1e-3 * scan_.length_mm},
            {"gain_percent", 100.0 * scan_.gain / ping1d::most_gain},
            {"sound_speed_mps", scan_.sound_speed_mps()},
            {"bins", ping1d::samples_of(scan_, device_.points).count}};
  }

  PingRecord record(int ping, std::vector<std::uint8_t> samples) const override {
    const ping1d::Echo echo =
        ping1d::find_echo(ping1d::amplitudes({.number = 0, .u8 = std::move(samples), .u16 = {}}), scan_,
                          device_.points, 1e3 * device_.least_range_m);
    ping1d::Distance measured = ping1d::measured_by(
        scan_, device_, static_cast<std::uint32_t>(std::lround(echo.distance_mm.value_or(0.0))),
        static_cast<std::uint16_t>(std::lround(echo.confidence_percent)));
    measured.ping_number = static_cast<std::uint32_t>(ping) + 1;
    PingRecord record = ping1d::record_of(measured, echo.profile, scan_.sound_speed_mps(), device_.id);
    record.number = static_cast<std::uint64_t>(ping);
    return record;
  }

 private:
  ping1d::DeviceConfig device_;
  ping1d::Scan scan_;
};

}  // namespace

std::unique_ptr<Survey> survey_of_ping1d(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<Ping1dSurvey>(head, options);
}

}  // namespace sonard::server
