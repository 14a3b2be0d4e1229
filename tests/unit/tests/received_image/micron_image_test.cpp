// SPDX-License-Identifier: Apache-2.0
// What a client of a Micron finds in its lines, through the settings of a job, the receiver and the codec
// (docs/physics.md 2.16).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/micron/codec.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "server/config/config.hpp"
#include "server/devices/micron/kind.hpp"
#include "server/devices/micron/settings.hpp"
#include "tests/support/correlation.hpp"

namespace sonard {
namespace {

constexpr int bins = 500;
constexpr double range_m = 25;

class MicronClient {
 public:
  explicit MicronClient(const server::HeadConfig& head) : head_(head) {}

  /// The next line, as decoded.
  std::vector<std::uint8_t> line(float intensity, bool transmit = true, double bearing_rad = 0) {
    PingJob job;
    job.bearing_rad = bearing_rad;
    job.native_bins = bins;
    job.native_bin_m = range_m / bins;
    job.sound_speed_mps = 1500;
    job.gain_db = server::micron_config(head_).nominal_gain_db;
    job.transmit = transmit;
    render::PingRequest request;
    request.settings = server::micron_sonar_settings(job, head_);
    request.T_world_sonar = server::T_world_transducer({}, job.bearing_rad);
    request.ping_number = ping_number_++;
    request.seed = 3;
    const render::EchoImage echo{1, bins, std::vector<float>(bins, intensity)};
    const std::vector<std::uint8_t> samples = receiver_.receive(echo, request, 0, workers_).u8;
    micron::HeadData sent;
    sent.control = micron::control_bits::eight_bit;
    sent.data = samples;
    const std::vector<std::uint8_t> frame = micron::encode(micron::Report{sent});
    const auto report = micron::decode_report(frame);
    const auto& received = std::get<micron::HeadData>(*report);
    return {received.data.begin(), received.data.end()};
  }

 private:
  server::HeadConfig head_;
  render::Receiver receiver_;
  render::WorkerPool workers_{1};
  std::uint64_t ping_number_ = 0;
};

std::size_t bin_at(double wanted_m) {
  return static_cast<std::size_t>(wanted_m / range_m * bins);
}

double decibels_of(std::uint8_t code) {
  return std::ceil(code * 160 / 255.0) / 2;  // code = floor(k 255 / 160), k half decibels
}

TEST(MicronImage, CodesAreOnTheHalfDecibelGridAndNoneIsAbove191) {
  std::set<int> grid;
  for (int k = 0; k <= 120; ++k) {
    grid.insert(k * 255 / 160);
  }
  EXPECT_EQ(*grid.rbegin(), 191);
  MicronClient client{server::micron_kind().make_default()};
  std::set<int> seen;
  for (float intensity = 1e-14F; intensity < 1e-2F; intensity *= 10) {
    for (const std::uint8_t code : client.line(intensity)) {
      ASSERT_TRUE(grid.contains(code)) << int{code};
      seen.insert(code);
    }
  }
  EXPECT_GT(seen.size(), 100u);
  EXPECT_EQ(*seen.rbegin(), 191);
}

// Blank first row; a peak at 0.2 to 0.35 m, gone by 0.8 to 1 m; the water behind it mostly exactly 0.
TEST(MicronImage, RingDownPeaksAndIsGoneWithinAMetre) {
  MicronClient client{server::micron_kind().make_default()};
  const std::vector<std::uint8_t> line = client.line(0);
  EXPECT_EQ(line[0], 0);
  const auto peak = std::max_element(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(bin_at(2)));
  const double peak_m = (static_cast<double>(peak - line.begin()) + 0.5) * range_m / bins;
  EXPECT_GE(peak_m, 0.2);
  EXPECT_LE(peak_m, 0.35);
  // A level of 6 dB, the TVG of 30 log 0.275 m, and the gain of -9 dB re 80 dB.
  EXPECT_NEAR(decibels_of(*peak), 6 + 30 * std::log10(0.275) - 9 + 80, 1);
  EXPECT_GT(line[bin_at(0.6)], 0);
  EXPECT_EQ(std::count(line.begin() + static_cast<std::ptrdiff_t>(bin_at(1)),
                       line.begin() + static_cast<std::ptrdiff_t>(bin_at(5)), 0),
            static_cast<std::ptrdiff_t>(bin_at(5) - bin_at(1)));
  EXPECT_EQ(client.line(0)[bin_at(0.3)], line[bin_at(0.3)]) << "it is the same in every ping";
}

TEST(MicronImage, AHeadThatOnlyListensDoesNotRing) {
  MicronClient client{server::micron_kind().make_default()};
  EXPECT_EQ(client.line(0, false)[bin_at(0.3)], 0);
}

// docs/physics.md 2.16: from sweep to sweep of a vehicle at rest echoes repeat by about 0.95, noise does not.
// An even echo 20 dB above the noise, and noise alone, at 40 dB in every bin; levels in dB.
TEST(MicronImage, EchoesRepeatFromSweepToSweepAndNoiseDoesNot) {
  server::HeadConfig head = server::micron_kind().make_default();
  head.acoustics.physical.tvg_log_coefficient = 0;
  head.acoustics.physical.tvg_absorption_db_per_m = 0;
  head.acoustics.physical.noise_level_db = 40 - 80 + 9 - 20;
  head.acoustics.physical.interference.probability = 0;
  const auto sweep = [](MicronClient& client, float intensity) {
    std::vector<double> levels;
    for (double bearing = -3; bearing < 3; bearing += 0.05) {
      const std::vector<std::uint8_t> line = client.line(intensity, true, bearing);
      for (std::size_t bin = bin_at(2); bin < line.size(); ++bin) {
        levels.push_back(std::pow(10, decibels_of(line[bin]) / 20));
      }
    }
    return levels;
  };
  const auto echo = static_cast<float>(std::pow(10, (40 - 80 + 9) / 10.0));
  MicronClient client{head};
  const double of_echo = test::correlation(sweep(client, echo), sweep(client, echo));
  head.acoustics.physical.noise_level_db += 20;
  MicronClient hearing_noise{head};
  const double of_noise = test::correlation(sweep(hearing_noise, 0), sweep(hearing_noise, 0));
  std::printf("echo %.3f, noise %.3f\n", of_echo, of_noise);
  EXPECT_GE(of_echo, 0.95);
  EXPECT_LT(std::abs(of_noise), 0.05);
}

// Noise of 40 dB in every bin, so that rises are seen: 7 % of 3000 pings are 210 +-14, and their raise is
// even between 2 and 11 dB, 6.5 +-2.6 on the average. A quarter of a line is 125 exponentials in intensity,
// whose mean level is known to 0.4 dB.
TEST(MicronImage, OnePingOfFourteenIsHitByInterferenceToItsEnd) {
  server::HeadConfig head = server::micron_kind().make_default();
  head.acoustics.physical.tvg_log_coefficient = 0;
  head.acoustics.physical.tvg_absorption_db_per_m = 0;
  head.acoustics.physical.noise_level_db = 40 - 80 + 9;
  MicronClient client{head};
  const auto level_db = [](const std::vector<std::uint8_t>& line, int from, int to) {
    double power = 0;
    for (int i = from; i < to; ++i) {
      power += std::pow(10.0, decibels_of(line[static_cast<std::size_t>(i)]) / 10);
    }
    return 10 * std::log10(power / (to - from));
  };
  constexpr int pings = 3000;
  int hit = 0;
  double raise_db = 0;
  for (int ping = 0; ping < pings; ++ping) {
    const std::vector<std::uint8_t> line = client.line(0);
    const double end_db = level_db(line, bins * 3 / 4, bins);
    if (end_db > 41.3) {
      ++hit;
      raise_db += end_db - 40;
      EXPECT_LT(end_db, 52.5);
    }
  }
  // Those that begin within the last eighth or so are not seen.
  EXPECT_GT(hit, 0.05 * pings);
  EXPECT_LT(hit, 0.10 * pings);
  EXPECT_NEAR(raise_db / hit, 6.3, 0.8);
}

}  // namespace
}  // namespace sonard
