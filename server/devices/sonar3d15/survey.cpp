// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/survey.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "protocol/sonar3d15/shot.hpp"
#include "server/devices/sonar3d15/config.hpp"
#include "server/devices/survey_options.hpp"

namespace sonard::server {
namespace {

namespace wire = sonar3d15;

/// The settings that a client would send.
wire::DeviceConfig with_options(wire::DeviceConfig device, const SurveyOptions& options) {
  const OptionsOf taken("Sonar 3D-15");
  taken.refuse("--gain", options.gain_percent.has_value());
  taken.refuse("--compression", options.compression_log2.has_value());
  taken.refuse("--bits", options.bits.has_value());
  taken.refuse("--bins", options.bins.has_value());
  taken.refuse("--step", options.step_deg.has_value());
  taken.refuse("--sector", !options.sector_deg.empty());
  taken.take("--range", options.range_m, 1.0, device.most_range_m, device.range_m);
  taken.take("--sound-speed", options.sound_speed_mps, 1000.0, 2000.0, device.automatic_sound_speed_mps);
  return device;
}

class Sonar3d15Survey final : public Survey {
 public:
  Sonar3d15Survey(const HeadConfig& head, const SurveyOptions& options)
      : device_(with_options(device_settings<Sonar3d15Config>(head).device, options)),
        settings_{.acoustics = true,
                  .high_frequency = options.frequency == "high",
                  .least_range_m = device_.least_range_m,
                  .range_m = device_.range_m,
                  .sound_speed_mps = device_.automatic_sound_speed_mps,
                  .imu_batches = false,
                  .udp_mode = wire::UdpMode::disabled,
                  .unicast = {}},
        images_(wire::make_shot(device_, settings_, settings_.sound_speed_mps)) {}

  std::chrono::nanoseconds natural_period() const override { return job(0).period; }

  std::vector<int> frames(int pings) override {
    std::vector<int> first_pings(static_cast<std::size_t>(pings) + 1);
    std::iota(first_pings.begin(), first_pings.end(), 0);
    return first_pings;
  }

  PingJob job(int ping) const override {
    PingJob job = wire::make_job(device_, settings_, settings_.sound_speed_mps);
    job.number = static_cast<std::uint64_t>(ping);
    return job;
  }

  double client_bin_m() const override { return job(0).bin_m(); }

  std::vector<double> bearings_rad() const override {
    std::vector<double> bearings;
    for (int column = 0; column < device_.columns; ++column) {
      bearings.push_back(wire::column_rad(images_.range, column));
    }
    return bearings;
  }

  nlohmann::ordered_json settings_json() const override {
    return {{"range_m", device_.range_m},
            {"least_range_m", device_.least_range_m},
            {"sound_speed_mps", settings_.sound_speed_mps},
            {"frequency", settings_.high_frequency ? "high" : "low"},
            {"columns", device_.columns},
            {"rows", device_.rows}};
  }

  DirectionRanges measured(const DirectionRanges& echoes) const override {
    wire::Shot shot = images_;
    wire::add_echoes(echoes, device_, device_.least_range_m, shot);
    DirectionRanges sent{device_.columns, device_.rows, {}, {}};
    for (int pixel = 0; pixel < device_.columns * device_.rows; ++pixel) {
      sent.range_m.push_back(static_cast<float>(wire::distance_m(shot.range, pixel)));
      const char code = shot.signal.image_pixel_data()[static_cast<std::size_t>(pixel)];
      sent.intensity.push_back(static_cast<float>(static_cast<std::uint8_t>(code)));
    }
    return sent;
  }

  PingRecord record_of_measured(int ping, const DirectionRanges& sent, std::int64_t unix_ns) const override {
    wire::Shot shot = images_;
    const auto scale_m = static_cast<double>(shot.range.image_pixel_scale());
    for (std::size_t i = 0; i < sent.range_m.size(); ++i) {
      shot.range.add_image_pixel_data(
          static_cast<std::uint32_t>(std::lround(static_cast<double>(sent.range_m[i]) / scale_m)));
      shot.signal.mutable_image_pixel_data()->push_back(
          static_cast<char>(static_cast<std::uint8_t>(sent.intensity[i])));
    }
    wire::set_header(std::chrono::nanoseconds{unix_ns}, static_cast<std::uint32_t>(ping), shot);
    std::vector<std::uint8_t> packets = wire::encode(shot.range, wire::PacketId::rip2);
    const std::vector<std::uint8_t> signal = wire::encode(shot.signal, wire::PacketId::rip2);
    packets.insert(packets.end(), signal.begin(), signal.end());
    PingRecord record = wire::record_of(shot, job(ping).frequency_hz, std::move(packets));
    record.number = static_cast<std::uint64_t>(ping);
    return record;
  }

 private:
  wire::DeviceConfig device_;
  wire::Settings settings_;
  wire::Shot images_;  ///< without echoes
};

}  // namespace

std::unique_ptr<Survey> survey_of_sonar3d15(const HeadConfig& head, const SurveyOptions& options) {
  return std::make_unique<Sonar3d15Survey>(head, options);
}

}  // namespace sonard::server
