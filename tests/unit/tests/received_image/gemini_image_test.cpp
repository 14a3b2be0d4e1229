// SPDX-License-Identifier: Apache-2.0
// Statistics of speckle and noise on the 8-bit image in the client: the head's job gives the settings, the
// receiver the samples, the head sends them, and a client assembles the image (T12 of docs/physics.md 3.2).
// Expected values are from 2.8 and 2.16.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/gemini_client.hpp"

namespace sonard {
namespace {

using Image = test::GeminiImage;

/// Head and client without losses between them; the world is an even echo.
class Client {
 public:
  Client(const render::SonarSettings& acoustics, int native_lines, int compression_log2 = 0)
      : acoustics_(acoustics) {
    gemini::PingSettings wanted;
    wanted.compression_log2 = compression_log2;
    config_ = gemini::make_ping_config(wanted);
    config_.end_range = static_cast<std::uint16_t>(native_lines);
  }

  std::vector<Image> images(int pings, float intensity) {
    server::HeadConfig head = server::gemini_type().make_default();
    head.acoustics = acoustics_;
    return test::GeminiClient(head, config_, test::EvenEcho(intensity)).images(pings);
  }

 private:
  render::SonarSettings acoustics_;
  gemini::PingConfig config_;
};

/// The head's own settings, but with the same gain at all ranges. If the echo or the noise has the intensity
/// `level`, its root is 57 codes: 255 is exceeded once in 5e8, and rounding to whole codes adds 1e-4 to the
/// variance.
constexpr double level = 0.05;

render::SonarSettings even_gain() {
  render::SonarSettings settings = server::gemini_acoustics();
  settings.physical.pulse.shape = render::PulseSettings::Shape::point;  // lines are independent
  settings.physical.speckle.texture_nu = 0;                             // and have a Rayleigh distribution
  settings.physical.tvg.log_coefficient = 0;
  settings.physical.tvg.absorption_db_per_m = 0;
  settings.physical.gain_db = 0;
  settings.physical.noise.level_db = 10 * std::log10(level);
  return settings;
}

/// A part of an image without the near field, which is 0, and without the stripe at broadside.
struct Part {
  const Image& image;
  int first_line = 100;
  int end_beam = 112;

  template <class Each>
  void for_each(int lag, const Each& each) const {
    for (int line = first_line; line < image.lines; ++line) {
      for (int beam = 0; beam + lag < end_beam; ++beam) {
        each(image.at(line, beam), image.at(line, beam + lag));
      }
    }
  }
};

double mean_of(const Part& part) {
  double sum = 0, n = 0;
  part.for_each(0, [&](double code, double) {
    sum += code;
    ++n;
  });
  return sum / n;
}

double covariance(const Part& part, int lag) {
  const double mean = mean_of(part);
  double sum = 0, n = 0;
  part.for_each(lag, [&](double a, double b) {
    sum += (a - mean) * (b - mean);
    ++n;
  });
  return sum / n;
}

/// Largest distance between the distribution of codes and Rayleigh's with the same mean power. A code means
/// the amplitudes within half a code.
double distance_from_rayleigh(const Part& part) {
  std::vector<double> count(256, 0.0);
  double power = 0, n = 0;
  part.for_each(0, [&](double code, double) {
    ++count[static_cast<std::size_t>(code)];
    power += code * code;
    ++n;
  });
  double below = 0, worst = 0;
  for (std::size_t code = 0; code < 255; ++code) {
    below += count[code] / n;
    const double edge = static_cast<double>(code) + 0.5;
    worst = std::max(worst, std::abs(below - (1 - std::exp(-edge * edge * n / power))));
  }
  return worst;
}

// About 2000 lines of 112 beams, of which a fourth are independent. Standard errors: CV 0.002, correlation
// 0.004.
void expect_speckle_of_the_array(const Image& image) {
  const Part part{image};
  std::printf("CV %.4f, Kolmogorov-Smirnov %.4f, correlation %.3f %.3f %.3f\n",
              std::sqrt(covariance(part, 0)) / mean_of(part), distance_from_rayleigh(part),
              covariance(part, 1) / covariance(part, 0), covariance(part, 2) / covariance(part, 0),
              covariance(part, 3) / covariance(part, 0));
  EXPECT_NEAR(mean_of(part), 255 * 0.8862 * std::sqrt(level), 1);
  const double variance = covariance(part, 0);
  EXPECT_NEAR(std::sqrt(variance) / mean_of(part), 0.5227, 0.02 * 0.5227);
  EXPECT_LT(distance_from_rayleigh(part), 0.02);
  EXPECT_NEAR(covariance(part, 1) / variance, 0.75, 0.04);
  EXPECT_NEAR(covariance(part, 2) / variance, 0.34, 0.04);
  EXPECT_NEAR(covariance(part, 3) / variance, 0.08, 0.04);
}

TEST(GeminiImage, EchoOfAnEvenWallIsRayleighAndCorrelatedByTheArray) {
  render::SonarSettings settings = even_gain();
  settings.physical.noise.on = false;
  expect_speckle_of_the_array(Client(settings, 2100).images(1, static_cast<float>(level)).front());
}

TEST(GeminiImage, NoiseOfEmptyWaterIsRayleighWithTheSameCorrelation) {
  expect_speckle_of_the_array(Client(even_gain(), 2100).images(1, 0).front());
}

double correlation(const Image& a, const Image& b) {
  const double mean_a = mean_of({a}), mean_b = mean_of({b});
  double sum = 0, square_a = 0, square_b = 0;
  for (int line = 100; line < a.lines; ++line) {
    for (int beam = 0; beam < 112; ++beam) {
      const double x = a.at(line, beam) - mean_a, y = b.at(line, beam) - mean_b;
      sum += x * y;
      square_a += x * x;
      square_b += y * y;
    }
  }
  return sum / std::sqrt(square_a * square_b);
}

// A sonar and a scene at rest, noise 20 dB below the echo: the pattern repeats, the noise does not.
TEST(GeminiImage, EchoesOfASonarAtRestRepeatAndNoiseDoesNot) {
  render::SonarSettings settings = even_gain();
  settings.physical.noise.level_db -= 20;
  const std::vector<Image> echo = Client(settings, 1100).images(3, static_cast<float>(level));
  EXPECT_GE(correlation(echo[0], echo[1]), 0.95);
  EXPECT_GE(correlation(echo[0], echo[2]), 0.95);
  EXPECT_NE(echo[0].codes, echo[1].codes);
  const std::vector<Image> noise = Client(even_gain(), 1100).images(3, 0);
  EXPECT_LT(std::abs(correlation(noise[0], noise[1])), 0.05);
  EXPECT_LT(std::abs(correlation(noise[0], noise[2])), 0.05);
}

double mean_level_db(const Image& image, double from_m, double to_m) {
  double power = 0, n = 0;
  for (int line = static_cast<int>(from_m / image.line_m); line < static_cast<int>(to_m / image.line_m);
       ++line) {
    for (int beam = 0; beam < 112; ++beam, ++n) {
      power += std::pow(image.at(line, beam), 2);
    }
  }
  return 10 * std::log10(power / n);
}

// The head's default settings, in empty water, at 50 m: noise rises with the TVG, then stays flat.
TEST(GeminiImage, NoiseFloorRisesWithTheTvgAndIsFlatOverTheLastQuarterOf50m) {
  const Image image = Client(server::gemini_acoustics(), 6028, 2).images(1, 0).front();
  EXPECT_NEAR(image.lines * image.line_m, 50, 0.1);
  std::vector<double> levels;
  for (double from_m = 37.5; from_m < 49; from_m += 1.25) {
    levels.push_back(mean_level_db(image, from_m, from_m + 1.25));
  }
  const auto [least, most] = std::minmax_element(levels.begin(), levels.end());
  EXPECT_LT(*most - *least, 1.0);
  EXPECT_GT(*least, 20 * std::log10(10)) << "it is seen";
  EXPECT_LT(*most, 20 * std::log10(128)) << "and leaves room for echoes";
  const double absorption = server::gemini_acoustics().physical.tvg.absorption_db_per_m;
  EXPECT_NEAR(mean_level_db(image, 29.5, 30.5) - mean_level_db(image, 24.5, 25.5),
              30 * std::log10(30.0 / 25) + 2 * absorption * 5, 0.5);
}

TEST(GeminiImage, TheSameSeedGivesTheSameBytes) {
  const auto all = [] {
    std::vector<std::uint8_t> codes;
    for (const Image& image : Client(even_gain(), 300).images(3, static_cast<float>(level))) {
      codes.insert(codes.end(), image.codes.begin(), image.codes.end());
    }
    return codes;
  };
  EXPECT_EQ(all(), all());
}

}  // namespace
}  // namespace sonard
