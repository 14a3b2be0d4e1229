// SPDX-License-Identifier: Apache-2.0
#include "server/devices/gemini/survey.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/ping_plan.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "protocol/gemini/recorded_form.hpp"
#include "server/devices/gemini/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

gemini::PingSettings client_settings(const SurveyOptions& options) {
  const OptionsOf taken("Gemini");
  taken.refuse("--frequency", options.frequency.has_value());
  taken.refuse("--bins", options.bins.has_value());
  taken.refuse("--step", options.step_deg.has_value());
  taken.refuse("--sector", !options.sector_deg.empty());
  gemini::PingSettings settings;
  taken.take("--range", options.range_m, 0.3, 150.0, settings.range_m);
  taken.take("--gain", options.gain_percent, 0.0, 100.0, settings.gain_percent);
  taken.take("--sound-speed", options.sound_speed_mps, 1400.0, 1588.0, settings.sound_speed_mps);
  settings.compression_log2 = options.compression_log2.value_or(settings.compression_log2);
  settings.sixteen_bit = options.bits == 16;
  return settings;
}

class GeminiSurvey final : public Survey {
 public:
  GeminiSurvey(const HeadConfig& head, const SurveyOptions& options)
      : config_(device_settings<GeminiConfig>(head)),
        asked_(client_settings(options)),
        // Every output of make_ping_config() is valid for plan_ping().
        plan_(gemini::plan_ping(gemini::make_ping_config(asked_), config_.device).value()) {}

  // The longest of: the head's own limit, the way of the last echo, the datagrams on the link
  // (protocol/gemini/README.md 8.4, 8.5).
  std::chrono::nanoseconds natural_period() const override {
    constexpr int head_and_tail = 2;
    const gemini::DeviceConfig& device = config_.device;
    return std::max({device.min_ping_period, plan_.job.listening_time,
                     (plan_.job.bins() + head_and_tail) * device.line_period});
  }

  PingJob job(int ping) const override {
    PingJob job = plan_.job;
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings(static_cast<std::size_t>(pings) + 1);
    std::iota(first_pings.begin(), first_pings.end(), 0);
    return first_pings;
  }

  double client_bin_m() const override {
    const int native_lines = 1 << plan_.job.compression_log2;
    return asked_.sound_speed_mps / (2.0 * gemini::line_rate_hz) * native_lines;
  }
  std::vector<double> bearings_rad() const override { return gemini::bearings_rad(); }

  nlohmann::ordered_json settings_json() const override {
    return {{"range_m", asked_.range_m},
            {"gain_percent", asked_.gain_percent},
            {"sound_speed_mps", asked_.sound_speed_mps},
            {"compression", plan_.job.compression_log2},
            {"bits", plan_.job.sixteen_bit ? 16 : 8},
            {"native_lines", plan_.job.native_bins}};
  }

  PingRecord record(int ping, std::vector<std::uint8_t> samples) const override {
    PingRecord record = gemini::record_of(plan_.head, {static_cast<std::uint64_t>(ping), {}, {}});
    record.number = static_cast<std::uint64_t>(ping);
    record.settings.gain_percent = plan_.job.gain_percent;
    record.samples = std::move(samples);
    return record;
  }

 private:
  GeminiConfig config_;
  gemini::PingSettings asked_;
  gemini::PingPlan plan_;
};

}  // namespace

std::unique_ptr<Survey> survey_of_gemini(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<GeminiSurvey>(head, options);
}

}  // namespace sonard::server
