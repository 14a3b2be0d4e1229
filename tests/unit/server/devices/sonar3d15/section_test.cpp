// SPDX-License-Identifier: Apache-2.0
// Values of the loader for a head of type sonar3d15, and the renderer's settings for its jobs.
#include "server/devices/sonar3d15/section.hpp"

#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "server/devices/device_type.hpp"
#include "server/devices/sonar3d15/type.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/server/config/config_text.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

class Sonar3d15Section : public ConfigFolder {
 protected:
  HeadConfig read(const std::string& more = "") const {
    return load(
               "world: {file: world.sdf}\nposes:\n  initial: {position_m: [1, 2, 3]}\nheads:\n"
               "  - {type: sonar3d15, name: bow, network: {address: 127.0.0.5}" +
               (more.empty() ? "" : ", " + more) + "}\n")
        .config.heads.at(0);
  }
};

TEST_F(Sonar3d15Section, GivesDefaultsForWhatIsLeftOut) {
  const HeadConfig head = read();
  EXPECT_EQ(head.type, &sonar3d15_type());
  const Sonar3d15Config& config = device_settings<Sonar3d15Config>(head);
  EXPECT_EQ(config.http_port, 80);
  EXPECT_EQ(config.multicast_ttl, 1);
  EXPECT_EQ(config.device.release, (sonar3d15::Release{1, 8, 0}));
  EXPECT_EQ(config.device.columns, 256);
  EXPECT_NEAR(config.device.gain, std::pow(10.0, 6.5), 1e-3);
  EXPECT_FALSE(config.device.acoustics);
  EXPECT_EQ(head.type->summary(head), "HTTP 127.0.0.5:80, images to 224.0.0.96:4747");
  const auto sockets = head.type->sockets(head);
  ASSERT_EQ(sockets.size(), 1U);
  EXPECT_EQ(sockets[0].transport, PlannedSocket::Transport::tcp);
}

TEST_F(Sonar3d15Section, TakesEveryKind) {
  const HeadConfig head = read(
      "time_scale: 2, device: {release: 1.5.1, packets: rip2, width: 64, height: 32, inside_temperature_c: "
      "50, "
      "range_step_us: 2, start: {acoustics: true, range_m: 10}}, high_frequency: {rate_hz: 10, latency_ms: "
      "5, "
      "horizontal_beamwidth_deg: 1, absorption_db_per_km: 1950}, acoustics: {gain_db: 100, threshold: 60, "
      "range_resolution_mm: 30}");
  const Sonar3d15Config& config = device_settings<Sonar3d15Config>(head);
  EXPECT_EQ(config.device.release, (sonar3d15::Release{1, 5, 1}));
  EXPECT_EQ(config.device.packets, sonar3d15::PacketId::rip2);
  EXPECT_TRUE(config.device.acoustics);
  EXPECT_EQ(config.device.time_scale, 2.0);
  EXPECT_NEAR(config.device.range_step_s, 2e-6, 1e-15);
  EXPECT_NEAR(config.device.gain, 1e5, 1e-6);
  EXPECT_NEAR(config.device.range_bin_m, 0.015, 1e-12);
  EXPECT_EQ(config.device.high.latency, 5ms);
  EXPECT_NEAR(config.modes[1].horizontal_beamwidth_rad, degree, 1e-12);
  EXPECT_NEAR(config.modes[1].absorption_db_per_m, 1.95, 1e-12);
}

TEST_F(Sonar3d15Section, TakesWhatRealHeadsMayDoOtherwise) {
  const HeadConfig head = read(
      "device: {sends_shaded: true, speed_change_s: 20, ntp_synced: false, clock_offset_s: -3600, "
      "imu: {force_noise_mps2: 0.05, rate_noise_dps: 2, batch_samples: 10}}");
  const sonar3d15::DeviceConfig& device = device_settings<Sonar3d15Config>(head).device;
  EXPECT_TRUE(device.sends_shaded);
  EXPECT_EQ(device.speed_change_time, 20s);
  EXPECT_EQ(device.clock_offset, -3600s);
  EXPECT_EQ(device.imu_force_noise_mps2, 0.05);
  EXPECT_NEAR(device.imu_rate_noise_radps, 2 * degree, 1e-12);
  EXPECT_EQ(device.imu_batch_samples, 10);
}

TEST_F(Sonar3d15Section, JobsSetDirectionsRangeAndWater) {
  const HeadConfig head = read("low_frequency: {absorption_db_per_km: 495}");
  PingJob job = sonar3d15_type().usual_job(head);
  const render::SonarSettings low = sonar3d15_type().sonar_settings(job, head);
  EXPECT_EQ(low.directions.columns, 256);
  EXPECT_EQ(low.directions.rows, 64);
  EXPECT_NEAR(low.directions.azimuth_fov_rad, 90 * degree, 1e-12);
  EXPECT_NEAR(low.directions.elevation_beamwidth_rad, 1.6 * degree, 1e-12);
  EXPECT_NEAR(low.directions.nearest_m, 0.3 * 1500 / 1491, 1e-9);
  EXPECT_NEAR(low.range.max_range_m(), 15.0 * 1500 / 1491, 0.011);
  EXPECT_NEAR(low.physical.absorption_db_per_m, 0.495, 1e-12);
  PingJob recorded = job;
  recorded.directions = {};
  EXPECT_EQ(sonar3d15_type().sonar_settings(recorded, head).aperture.beam_count(), 1);
  job.mode = 1;
  EXPECT_NEAR(sonar3d15_type().sonar_settings(job, head).directions.elevation_beamwidth_rad, 0.85 * degree,
              1e-12);
}

}  // namespace
}  // namespace sonard::server
