// SPDX-License-Identifier: Apache-2.0
// Responses of array, pulse and TVG to simple targets, against closed forms, on all engines.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "tests/support/closed_forms.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::make_body;
using test::make_quad;
using test::make_sphere;
using test::make_world;

constexpr double pi = std::numbers::pi;

class Reception : public test::EngineTest {
 protected:
  /// Slices find small targets by themselves; a grid must be fine enough.
  static Sampling sampling_of_small_things() {
    return GetParam() == EngineKind::cpu ? Sampling{} : Sampling::of_grid(1, 1024, 512);
  }
};
INSTANTIATE_TEST_SUITE_P(Engines, Reception, test::all_engines(), test::engine_name);

World ball_at(double range_m, double azimuth_rad, double radius_m) {
  World world = make_world({make_body("ball", make_sphere(static_cast<float>(radius_m), 32), 0.1)});
  world.bodies[0].T_world_body.position_m = {range_m * std::cos(azimuth_rad), range_m * std::sin(azimuth_rad),
                                             0};
  return world;
}

/// The middle of a Gemini's fan: beams of a Gemini's width, within 10 degrees of the axis.
constexpr double gemini_spacing = 2 * 0.8660254037844386 / 256;
constexpr int beams = 50;

PingRequest middle_of_a_gemini() {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(beams, std::asin(gemini_spacing * beams / 2));
  request.settings.aperture.azimuth = Aperture::Azimuth::array;
  request.settings.physical.absorption_db_per_m = 0;
  request.settings.physical.tvg.absorption_db_per_m = 0;
  return request;
}

/// Power of 155 half-wave elements under a Hamming taper (docs/physics.md 2.5, 2.8).
double array_db(double sine_offset) {
  double sum = 0;
  double total = 0;
  for (int i = 0; i < 155; ++i) {
    const double weight = 0.54 - 0.46 * std::cos(2 * pi * i / 154);
    sum += weight * std::cos(pi * (i - 77) * sine_offset);
    total += weight;
  }
  return 20 * std::log10(std::abs(sum / total) + 1e-15);
}

// A ball a third of a fine beam wide, in the middle of one, in empty water.
TEST_P(Reception, APointIsHeardWithThePatternOfTheArray) {
  PingRequest request = middle_of_a_gemini();
  request.settings.range = {300, 0.04, 0, false};
  request.settings.sampling = sampling_of_small_things();
  const double target_sine = gemini_spacing * 4.25;  // the port half of beam 20
  SonarRenderer renderer(ball_at(10, std::asin(target_sine), 0.006), options());
  const EchoImage& echo = renderer.render_echo(request);
  ASSERT_EQ(echo.beams, beams);
  const auto level_db = [&](int b) {
    const auto* row = &echo.intensity[static_cast<std::size_t>(b * echo.bins)];
    return 10 * std::log10(std::accumulate(row, row + echo.bins, 1e-30));
  };
  const auto truth_db = [&](int b) {
    const double axis = gemini_spacing * (beams / 2.0 - 0.5 - b);
    return array_db(target_sine - axis);
  };
  int compared = 0;
  for (int b = 0; b < beams; ++b) {
    if (truth_db(b) > -30) {
      EXPECT_NEAR(level_db(b) - level_db(20), truth_db(b) - truth_db(20), 0.5) << b;
      ++compared;
    }
  }
  EXPECT_GE(compared, 6);
}

// The same ball with a chirp of 25 kHz, compared down to -30 dB.
TEST_P(Reception, APointIsHeardWithTheResponseOfThePulse) {
  constexpr double cell_m = 0.03;
  constexpr double line_m = 0.002;
  constexpr double radius_m = 0.006;
  PingRequest request = middle_of_a_gemini();
  request.settings.range = {5300, line_m, 0, false};
  request.settings.sampling = sampling_of_small_things();
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = cell_m;
  SonarRenderer renderer(ball_at(10, 0, radius_m), options());
  const EchoImage& echo = renderer.render_echo(request);
  std::vector<double> lines(5300, 0.0);
  for (int b = 0; b < beams; ++b) {
    for (std::size_t k = 0; k < lines.size(); ++k) {
      lines[k] += static_cast<double>(echo.at(b, static_cast<int>(k)));
    }
  }
  // T4 convolved with sinc^2.
  const auto truth = [&](int line) {
    double sum = 0;
    constexpr double dr = 1e-4;
    for (double r = 10 - radius_m; r < 10; r += dr) {
      const double x = pi * ((line + 0.5) * line_m - r - dr / 2) / cell_m;
      sum += test::sphere_echo(radius_m, 10, r, r + dr) * std::pow(std::sin(x) / x, 2);
    }
    return sum;
  };
  const auto strongest = std::max_element(lines.begin(), lines.end());
  const auto peak = static_cast<int>(strongest - lines.begin());
  const double scale_db = 10 * std::log10(*strongest / truth(peak));
  int compared = 0;
  for (int k = peak - 100; k <= peak + 100; ++k) {
    const double here = truth(k) / truth(peak);
    // Skips lines near the zeros of the response.
    if (here > 1e-3 && here > 0.5 * std::max(truth(k - 3), truth(k + 3)) / truth(peak)) {
      EXPECT_NEAR(10 * std::log10(lines[static_cast<std::size_t>(k)] / truth(k)) - scale_db, 0, 0.5)
          << k - peak;
      ++compared;
    }
  }
  EXPECT_GT(compared, 80);
}

TEST_P(Reception, AWallKeepsItsLevel) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  request.settings.range = {300, 0.1, 0, false};
  request.settings.sampling.preset = Sampling::Preset::fast;
  const World wall = make_world({make_body("wall", make_quad({10, -60, -20}, {0, 120, 0}, {0, 0, 40}))});
  const auto totals = [&](Aperture::Azimuth azimuth) {
    request.settings.aperture.azimuth = azimuth;
    SonarRenderer renderer(wall, options());
    const EchoImage& echo = renderer.render_echo(request);
    std::vector<double> sums;
    for (int b = 0; b < echo.beams; ++b) {
      const auto* row = &echo.intensity[static_cast<std::size_t>(b * echo.bins)];
      sums.push_back(std::accumulate(row, row + echo.bins, 0.0));
    }
    return sums;
  };
  const std::vector<double> ideal = totals(Aperture::Azimuth::ideal);
  const std::vector<double> array = totals(Aperture::Azimuth::array);
  for (std::size_t b = 4; b < 252; ++b) {  // the outermost have neighbours on one side only
    EXPECT_NEAR(array[b] / ideal[b], 1, 0.02) << b;
  }
}

/// Sine of the bearing of the echo's centroid, and the whole echo.
std::pair<double, double> centre_and_sum(const EchoImage& echo, const std::vector<double>& edges_rad) {
  double sum = 0;
  double moment = 0;
  for (int b = 0; b < echo.beams; ++b) {
    const auto beam = static_cast<std::size_t>(b);
    const auto* row = &echo.intensity[beam * static_cast<std::size_t>(echo.bins)];
    const double heard = std::accumulate(row, row + echo.bins, 0.0);
    sum += heard;
    moment += heard * (std::sin(edges_rad[beam]) + std::sin(edges_rad[beam + 1])) / 2;
  }
  return {moment / sum, sum};
}

// docs/physics.md 2.5: sin psi_c = sin psi cos theta. Two degrees at psi = 50 and theta = 15.
TEST_P(Reception, AStraightArrayMeasuresConeAngles) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  request.settings.aperture.vertical_beamwidth_rad = 40 * degree;
  request.settings.aperture.azimuth = Aperture::Azimuth::array;
  request.settings.physical.absorption_db_per_m = 0;
  request.settings.range = {120, 0.1, 0, false};
  request.settings.sampling = GetParam() == EngineKind::cpu ? Sampling{} : Sampling::of_grid(3, 512, 512);
  for (const double elevation : {15.0, -8.0}) {
    const double psi = 50 * degree;
    const double theta = elevation * degree;
    World world = ball_at(10, 0, 0.1);
    world.bodies[0].T_world_body.position_m = {10 * std::cos(theta) * std::cos(psi),
                                               10 * std::cos(theta) * std::sin(psi), 10 * std::sin(theta)};
    SonarRenderer renderer(world, options());
    request.settings.aperture.bearing = Aperture::Bearing::planar;
    const auto [planar, whole] =
        centre_and_sum(renderer.render_echo(request), request.settings.aperture.beam_edges_rad);
    request.settings.aperture.bearing = Aperture::Bearing::conical;
    const auto [conical, same] =
        centre_and_sum(renderer.render_echo(request), request.settings.aperture.beam_edges_rad);
    // A fine beam is 0.0034 wide in the sine of the bearing.
    EXPECT_NEAR(planar, std::sin(psi), 4e-4);
    EXPECT_NEAR(conical, std::sin(psi) * std::cos(theta), 4e-4);
    EXPECT_NEAR(same / whole, 1, 0.02);
  }
}

// A target beyond the end of the fan appears inside of it.
TEST_P(Reception, ConesReachBeyondTheFan) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  request.settings.aperture.azimuth = Aperture::Azimuth::array;
  request.settings.aperture.bearing = Aperture::Bearing::conical;
  request.settings.physical.absorption_db_per_m = 0;
  request.settings.range = {120, 0.1, 0, false};
  request.settings.sampling = GetParam() == EngineKind::cpu ? Sampling{} : Sampling::of_grid(3, 512, 512);
  const double psi = 60.6 * degree;
  const double theta = 9 * degree;
  World world = ball_at(10, 0, 0.04);
  world.bodies[0].T_world_body.position_m = {10 * std::cos(theta) * std::cos(psi),
                                             10 * std::cos(theta) * std::sin(psi), 10 * std::sin(theta)};
  SonarRenderer renderer(world, options());
  const EchoImage& echo = renderer.render_echo(request);
  const double sine = std::sin(psi) * std::cos(theta);  // 0.8605, of 0.8660
  const int beam = static_cast<int>((std::sin(60 * degree) - sine) / gemini_spacing);
  std::vector<double> sums;
  for (int b = 0; b < 6; ++b) {
    const auto* row = &echo.intensity[static_cast<std::size_t>(b * echo.bins)];
    sums.push_back(std::accumulate(row, row + echo.bins, 0.0));
  }
  EXPECT_GT(sums[static_cast<std::size_t>(beam)], 0);
  EXPECT_EQ(std::max_element(sums.begin(), sums.end()) - sums.begin(), beam);
}

// With an element seed, the mean echo does not depend on the seed of the ping.
TEST_P(Reception, ElementsHaveASeedOfTheirOwn) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(64, 60 * degree);
  request.settings.aperture.azimuth = Aperture::Azimuth::array;
  request.settings.aperture.element_amplitude_sd = 0.12;
  request.settings.range = {160, 0.1, 0, false};
  SonarRenderer renderer(ball_at(10, 0.3, 0.5), options());
  const auto echo = [&](std::uint64_t seed, std::optional<std::uint64_t> element_seed) {
    request.seed = seed;
    request.settings.aperture.element_seed = element_seed;
    return renderer.render_echo(request).intensity;
  };
  const std::vector<float> first = echo(1, 5);
  EXPECT_EQ(echo(2, 5), first);
  EXPECT_EQ(echo(5, std::nullopt), first) << "without one, the seed of the ping draws them";
  EXPECT_NE(echo(1, std::nullopt), first);
  EXPECT_NE(echo(1, 6), first);
}

// docs/physics.md 2.16, in the samples of a client: more than 60 beams from a strong target, the median of a
// row is about 35 dB below its peak, with the default errors of a Gemini.
TEST_P(Reception, AStrongTargetLeaksAlongItsRow) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  request.settings.aperture.azimuth = Aperture::Azimuth::array;
  request.settings.aperture.element_amplitude_sd = 0.12;
  request.settings.aperture.element_phase_sd_rad = 7 * degree;
  request.settings.sixteen_bit = true;
  request.settings.range = {160, 0.1, 0, false};
  request.settings.sampling.preset = Sampling::Preset::fast;
  request.settings.physical.gain_db = 24;
  SonarRenderer renderer(ball_at(10, 0.3, 0.5), options());
  std::vector<double> leaks_db;
  for (request.seed = 1; request.seed <= 15; ++request.seed) {
    const PingSamples samples = renderer.render_ping(request);
    const auto peak = std::max_element(samples.u16.begin(), samples.u16.end()) - samples.u16.begin();
    const std::ptrdiff_t line = peak / samples.beams;
    const std::ptrdiff_t beam = peak % samples.beams;
    ASSERT_LT(samples.u16[static_cast<std::size_t>(peak)], 65535) << "saturated";
    std::vector<std::uint16_t> far;
    for (std::ptrdiff_t b = 0; b < samples.beams; ++b) {
      if (std::abs(b - beam) > 60) {
        far.push_back(samples.u16[static_cast<std::size_t>(line * samples.beams + b)]);
      }
    }
    std::nth_element(far.begin(), far.begin() + static_cast<std::ptrdiff_t>(far.size() / 2), far.end());
    leaks_db.push_back(20 * std::log10(far[far.size() / 2] /
                                       static_cast<double>(samples.u16[static_cast<std::size_t>(peak)])));
  }
  // The peak of a single row is one draw of speckle and varies by some decibels.
  const double mean =
      std::accumulate(leaks_db.begin(), leaks_db.end(), 0.0) / static_cast<double>(leaks_db.size());
  RecordProperty("leak_db", std::to_string(mean));
  EXPECT_NEAR(mean, -35, 4);
}

/// Sum of the squared samples of a ping without speckle and noise, re full scale, dB.
double level_db(SonarRenderer& renderer, PingRequest request, double tvg_log_coefficient) {
  request.settings.sixteen_bit = true;
  PhysicalModel& model = request.settings.physical;
  model.speckle.kind = SpeckleSettings::Kind::off;
  model.noise.on = false;
  model.near_field_blank_m = 0;
  model.tvg.max_db = 200;
  model.tvg.log_coefficient = tvg_log_coefficient;
  const PingSamples samples = renderer.render_ping(request);
  double sum = 0;
  for (const std::uint16_t sample : samples.u16) {
    EXPECT_LT(sample, 65535);
    sum += std::pow(sample / 65535.0, 2);
  }
  return 10 * std::log10(sum);
}

// T10. The balls are 2 mrad wide at every range, so their target strength grows with the square of the range.
TEST_P(Reception, Tvg40KeepsTheLevelOfAPoint) {
  std::vector<double> levels_db;
  for (const double range_m : {1.0, 3.0, 10.0, 30.0, 100.0}) {
    PingRequest request = middle_of_a_gemini();
    request.settings.aperture.azimuth = Aperture::Azimuth::ideal;
    request.settings.aperture.beam_edges_rad = equal_angle_edges(3, 6 * degree);
    request.settings.physical.absorption_db_per_m = 0.2;
    request.settings.physical.tvg.absorption_db_per_m = 0.2;
    request.settings.range = {120, range_m / 100, 0, false};
    request.settings.sampling = sampling_of_small_things();
    const double radius_m = 1e-3 * range_m;
    request.settings.physical.gain_db = -10 - 20 * std::log10(radius_m);
    SonarRenderer renderer(ball_at(range_m * 1.005, 0, radius_m), options());
    levels_db.push_back(level_db(renderer, request, 40) - request.settings.physical.gain_db -
                        20 * std::log10(radius_m));
  }
  // TS of a small Lambert ball: 10 log10(2/3 pi a^2 mu).
  for (const double level : levels_db) {
    EXPECT_NEAR(level, levels_db[2], 0.1);
    EXPECT_NEAR(level, 10 * std::log10(2.0 / 3 * pi * 0.1), GetParam() == EngineKind::cpu ? 0.1 : 0.5)
        << "of the ball, the grid hits some pixels only";
  }
}

TEST_P(Reception, Tvg20KeepsTheLevelOfAWall) {
  std::vector<double> levels_db;
  for (const double range_m : {1.0, 10.0, 100.0}) {
    PingRequest request = middle_of_a_gemini();
    request.settings.physical.absorption_db_per_m = 0.05;
    request.settings.physical.tvg.absorption_db_per_m = 0.05;
    request.settings.range = {220, range_m / 200, 0, false};
    const auto half = static_cast<float>(range_m);
    SonarRenderer renderer(
        make_world({make_body("wall", make_quad({half, -half, -half}, {0, 2 * half, 0}, {0, 0, 2 * half}))}),
        options());
    request.settings.physical.gain_db = 20;
    levels_db.push_back(level_db(renderer, request, 20));
  }
  for (const double level : levels_db) {
    EXPECT_NEAR(level, levels_db[0], 0.1);
  }
}

// h^2 / 4 (r1^-4 - r2^-4) times r^3 falls as r^-2.
TEST_P(Reception, Tvg30LeavesABedFallingWithTheSquareOfTheRange) {
  PingRequest request = middle_of_a_gemini();
  request.T_world_sonar.position_m.z = 2;
  const World bed = make_world({make_body("bed", make_quad({-60, -60, 0}, {120, 0, 0}, {0, 120, 0}))});
  std::vector<double> levels_db;
  for (const int lines : {125, 245, 485}) {
    // Only the last ten lines count: the lines before them are blanked.
    request.settings.range = {lines, 0.1, 0, false};
    request.settings.physical.gain_db = 35;
    SonarRenderer renderer(bed, options());
    PingRequest blanked = request;
    blanked.settings.sixteen_bit = true;
    PhysicalModel& model = blanked.settings.physical;
    model.speckle.kind = SpeckleSettings::Kind::off;
    model.noise.on = false;
    model.tvg.max_db = 200;
    model.tvg.log_coefficient = 30;
    model.near_field_blank_m = (lines - 10) * 0.1;
    double sum = 0;
    for (const std::uint16_t sample : renderer.render_ping(blanked).u16) {
      ASSERT_LT(sample, 65535);
      sum += std::pow(sample / 65535.0, 2);
    }
    levels_db.push_back(10 * std::log10(sum));
  }
  EXPECT_NEAR(levels_db[1] - levels_db[0], -20 * std::log10(2.0), 0.1);
  EXPECT_NEAR(levels_db[2] - levels_db[1], -20 * std::log10(2.0), 0.1);
}

}  // namespace
}  // namespace sonard::render
