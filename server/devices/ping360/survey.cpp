// SPDX-License-Identifier: Apache-2.0
#include "server/devices/ping360/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "protocol/ping360/make_job.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "protocol/ping360/sweep.hpp"
#include "protocol/ping360/units.hpp"
#include "protocol/ping360/usual_scan.hpp"
#include "server/devices/ping360/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

constexpr double gradian_rad = 2.0 * std::numbers::pi / ping360::gradians_per_turn;
constexpr int most_step = 10;

/// The scan that a user requests, in the head's units.
struct Asked {
  double range_m = 10.0;
  double sound_speed_mps = 1500.0;
  ping360::AutoTransmit scan;
  bool all_round = true;
};

void take_step(const std::optional<double>& step_deg, ping360::AutoTransmit& scan) {
  if (!step_deg) {
    return;
  }
  const int gradians = static_cast<int>(std::lround(*step_deg / ping360::gradian_deg));
  if (gradians < 1 || gradians > most_step || std::abs(gradians * ping360::gradian_deg - *step_deg) > 1e-6) {
    throw CLI::ValidationError(
        "--step", fmt::format("expected a multiple of {} degrees, {} at most, found {}", ping360::gradian_deg,
                              most_step * ping360::gradian_deg, *step_deg));
  }
  scan.num_steps = static_cast<std::uint8_t>(gradians);
}

void take_sector(const std::vector<double>& sector_deg, int ahead, Asked& asked) {
  if (sector_deg.empty()) {
    return;
  }
  asked.all_round = false;
  const int start = ping360::angle_of(sector_deg[0], ahead);
  const int stop = ping360::angle_of(sector_deg[1], ahead);
  if (start == stop) {
    throw CLI::ValidationError("--sector", "FROM and TO are equal; omit --sector to scan all round");
  }
  asked.scan.start_angle = static_cast<std::uint16_t>(start);
  asked.scan.stop_angle = static_cast<std::uint16_t>(stop);
}

Asked asked_of(const SurveyOptions& options, const ping360::DeviceConfig& device) {
  const OptionsOf taken("Ping360");
  taken.refuse("--frequency", options.frequency.has_value());
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bits", options.bits.has_value());
  Asked asked;
  double gain_percent = 50.0;
  taken.take("--range", options.range_m, 0.5, 100.0, asked.range_m);
  taken.take("--gain", options.gain_percent, 0.0, 100.0, gain_percent);
  taken.take("--sound-speed", options.sound_speed_mps, 1300.0, 1700.0, asked.sound_speed_mps);
  if (options.bins && (*options.bins < 200 || *options.bins > 1200)) {
    throw CLI::ValidationError(
        "--bins", fmt::format("{} is out of range for Ping360 (expected 200 to 1200)", *options.bins));
  }
  const auto scan =
      ping360::usual_scan(asked.range_m, options.bins, asked.sound_speed_mps, device.bearing_offset);
  if (!scan) {
    throw CLI::ValidationError("--bins", fmt::format("{} bins over {} m are too fine for a head",
                                                     options.bins.value_or(0), asked.range_m));
  }
  asked.scan = *scan;
  asked.scan.gain_setting = static_cast<std::uint8_t>(std::lround(gain_percent / 50.0));
  take_step(options.step_deg, asked.scan);
  take_sector(options.sector_deg, device.bearing_offset, asked);
  return asked;
}

class Ping360Survey final : public Survey {
 public:
  Ping360Survey(const HeadConfig& head, const SurveyOptions& options)
      : device_(device_settings<Ping360Config>(head).device), asked_(asked_of(options, device_)) {}

  std::chrono::nanoseconds natural_period() const override {
    const auto listening = ping360::listening_time(asked_.scan.number_of_samples, asked_.scan.sample_period);
    const std::chrono::nanoseconds period =
        listening + device_.ping_overhead + asked_.scan.num_steps * device_.time_per_gradian;
    return std::max(listening, std::chrono::nanoseconds{static_cast<std::int64_t>(
                                   device_.time_scale * static_cast<double>(period.count()))});
  }

  // A one-way scan ends before its first angle comes again; a scan to and fro ends with the ping at the other
  // limit.
  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings{0};
    angles_.clear();
    ping360::Sweep sweep(asked_.scan.start_angle, asked_.scan.stop_angle, asked_.scan.num_steps,
                         device_.clamps_scan_to_stop);
    int before = asked_.scan.start_angle;
    int way_before = 0;
    // One ping more shows whether the last one ended a frame.
    for (int ping = 0; ping <= pings; ++ping) {
      const int angle = sweep.angle();
      const int way = ping360::shortest_turn(before, angle);
      const bool turned = sweep.one_way() ? ping > 0 && angle == asked_.scan.start_angle
                                          : way_before != 0 && (way > 0) != (way_before > 0);
      if (turned) {
        first_pings.push_back(ping);
      }
      if (ping < pings) {
        angles_.push_back(angle);
      }
      before = angle;
      way_before = way;
      sweep.advance();
    }
    return first_pings;
  }

  PingJob job(int ping) const override {
    PingJob job =
        ping360::make_job(ping360::form_of(asked_.scan, angles_.at(static_cast<std::size_t>(ping))), device_);
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  double client_bin_m() const override {
    return ping360::sample_time_s(asked_.scan.sample_period) * asked_.sound_speed_mps / 2.0;
  }

  Sector sector() const override {
    if (asked_.all_round) {
      return {-std::numbers::pi, 2.0 * std::numbers::pi, asked_.scan.num_steps * gradian_rad};
    }
    return {ping360::bearing_rad(asked_.scan.start_angle, device_.bearing_offset),
            ping360::wrapped(asked_.scan.stop_angle - asked_.scan.start_angle) * gradian_rad,
            asked_.scan.num_steps * gradian_rad};
  }

  nlohmann::ordered_json settings_json() const override {
    const auto degrees = [this](int angle) {
      return ping360::bearing_rad(angle, device_.bearing_offset) * 180.0 / std::numbers::pi;
    };
    nlohmann::ordered_json settings = {{"range_m", asked_.range_m},
                                       {"gain_percent", 50 * asked_.scan.gain_setting},
                                       {"sound_speed_mps", asked_.sound_speed_mps},
                                       {"bins", asked_.scan.number_of_samples},
                                       {"step_deg", asked_.scan.num_steps * ping360::gradian_deg},
                                       {"sector_deg", nullptr}};
    if (!asked_.all_round) {
      settings["sector_deg"] = {degrees(asked_.scan.start_angle), degrees(asked_.scan.stop_angle)};
    }
    return settings;
  }

  PingRecord record(int ping, std::vector<std::uint8_t> samples) const override {
    const ping360::PingForm form = ping360::form_of(asked_.scan, angles_.at(static_cast<std::size_t>(ping)));
    PingRecord record = Survey::record(ping, std::move(samples));
    record.settings.frequency_hz = 1e3 * asked_.scan.transmit_frequency_khz;
    record.wire = ping360::recorded_wire(form, device_.id);
    return record;
  }

 private:
  ping360::DeviceConfig device_;
  Asked asked_;
  std::vector<int> angles_;  ///< of every ping planned by frames(), in gradians
};

}  // namespace

std::unique_ptr<Survey> survey_of_ping360(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<Ping360Survey>(head, options);
}

}  // namespace sonard::server
