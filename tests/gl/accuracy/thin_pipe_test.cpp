// SPDX-License-Identifier: Apache-2.0
// A pipe of 5 cm at 30 m is found at any place between two samples, upright or lying. A thinner one ends
// where it ends, although its height is below the spacing of samples.
#include <cmath>
#include <numbers>

#include "tests/bench/reference.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

constexpr double range_m = 30, radius_m = 0.025, half_length_m = 0.4;
constexpr int pipes = 50;
using Preset = render::Sampling::Preset;

class ThinPipe : public AccuracyTest {
 protected:
  /// Share of the pipes whose echo, within a third of a metre of its place, exceeds half of the closed form.
  double detected(bool upright) const {
    std::vector<render::Body> bodies;
    std::vector<double> bearings;
    for (int i = 0; i < pipes; ++i) {
      // One every 2.3 degrees, off any regular grid: by the golden ratio in bearing, by sqrt 2 in height.
      const double offset = std::fmod(i * std::numbers::phi, 1.0);
      const double bearing = (2.3 * (i - (pipes - 1) / 2.0) + 0.8 * (offset - 0.5)) * degree;
      const double z = 4 * (std::fmod(i * std::numbers::sqrt2, 1.0) - 0.5);
      const glm::dvec3 centre(range_m * std::cos(bearing), range_m * std::sin(bearing), z);
      const glm::dvec3 half =
          half_length_m *
          (upright ? glm::dvec3(0, 0, 1) : glm::dvec3(-std::sin(bearing), std::cos(bearing), 0));
      bodies.push_back(
          make_body("pipe" + std::to_string(i), make_tube(centre - half, centre + half, radius_m, 32, 1)));
      bearings.push_back(bearing);
    }
    const Scene scene = forward_looking_scene(std::move(bodies), {1000, 0.032, 0, false});
    const render::EchoImage image = render(scene);
    int found = 0;
    for (const double bearing : bearings) {
      found += heard(image, scene.settings, bearing) > 0.5 * expected() ? 1 : 0;
    }
    return static_cast<double>(found) / pipes;
  }

 private:
  static double heard(const render::EchoImage& image, const render::SonarSettings& settings, double bearing) {
    const double aside = (half_length_m + 0.2) / range_m;
    double sum = 0;
    for (int beam = 0; beam < image.beams; ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      if (settings.aperture.beam_edges_rad[b] < bearing - aside ||
          settings.aperture.beam_edges_rad[b + 1] > bearing + aside) {
        continue;
      }
      for (int k = static_cast<int>((range_m - 0.33) / 0.032); k < static_cast<int>((range_m + 0.33) / 0.032);
           ++k) {
        sum += static_cast<double>(image.at(beam, k));
      }
    }
    return sum;
  }

  /// T5 of an upright pipe whose middle is nearest; lying pipes have the same echo.
  static double expected() {
    const double aside = std::asin(radius_m / range_m);
    return azimuth_integral(
        [](double psi) {
          return cylinder_density(radius_m, range_m, std::atan(half_length_m / range_m), psi, 0, 2 * range_m);
        },
        -aside, aside, 1000);
  }
};

INSTANTIATE_TEST_SUITE_P(Accuracy, ThinPipe, all_cases(), case_name);

TEST_P(ThinPipe, Upright) {
  const double share = detected(true);
  std::printf("detected %.3f\n", share);
  EXPECT_GE(share, targets().pipes_detected);
}

TEST_P(ThinPipe, Lying) {
  const double share = detected(false);
  std::printf("detected %.3f\n", share);
  EXPECT_GE(share, targets().pipes_detected);
}

/// Engine `cpu`: the rasteriser samples elevations.
class LyingRod : public AccuracyTest {
 protected:
  static constexpr double distance_m = 40, beam_rad = 120.0 / 256 * degree;

  /// Echo of the beam that holds the rod's end, re the echo of the next beam, which the rod fills.
  double share_in_last_beam(const render::TriangleMesh& rod) const {
    const Scene scene = forward_looking_scene({make_body("rod", rod)}, {1200, 0.04, 0, false});
    const render::EchoImage image = render(scene);
    const auto total = [&](int beam) {
      double sum = 0;
      for (int k = 0; k < 1200; ++k) {
        sum += static_cast<double>(image.at(beam, k));
      }
      return sum;
    };
    return total(last_beam) / total(last_beam + 1);
  }

  /// The end at a share of the beam, counted from its starboard edge.
  static double end_m(double share) {
    return distance_m * std::tan((128 - last_beam - 1 + share) * beam_rad);
  }

  static constexpr int last_beam = 122;  // from 5 to 6 beams to port of the middle
  double allowed() const { return GetParam().preset == Preset::fast ? 0.04 : 0.01; }
};

INSTANTIATE_TEST_SUITE_P(Accuracy, LyingRod,
                         ::testing::Values(AccuracyCase{render::EngineKind::cpu, Preset::fast},
                                           AccuracyCase{render::EngineKind::cpu, Preset::normal}),
                         case_name);

// The elevation of the rod is 0.5 mrad high, and profiles of slices have a probe every 1.4 mrad.
TEST_P(LyingRod, EndsWithItsLid) {
  for (const double share : {0.05, 0.2, 0.45, 0.55, 0.7, 0.9}) {
    const auto rod = make_tube({distance_m, -3, 0}, {distance_m, end_m(share), 0}, 0.01, 12, 1);
    EXPECT_NEAR(share_in_last_beam(rod), share, allowed());
  }
}

TEST_P(LyingRod, EndsWithoutALid) {
  for (const double share : {0.05, 0.2, 0.45, 0.55, 0.7, 0.9}) {
    const double length_m = end_m(share) + 3;
    const auto strip =
        make_quad({distance_m, -3, -0.01F}, {0, static_cast<float>(length_m), 0}, {0, 0, 0.02F});
    EXPECT_NEAR(share_in_last_beam(strip), share, allowed());
  }
}

// Many small triangles, as of a mesh from a CAD program: clusters of it lie within a beam.
TEST_P(LyingRod, EndsIfItIsFinelyDivided) {
  for (const double share : {0.2, 0.7}) {
    const auto rod = make_tube({distance_m, -3, 0}, {distance_m, end_m(share), 0}, 0.01, 32, 64);
    EXPECT_NEAR(share_in_last_beam(rod), share, allowed());
  }
}

// Against the oracle: 40 pipes of 2 to 20 cm at 5 to 80 m, upright and lying.
TEST_P(LyingRod, AndOthersAreAsTheOracleSeesThem) {
  const Scene scene = make_scene("b7_pipes");
  const auto reference = bench::find_reference(scene, SONARD_SOURCE_DIR "/tests/data/oracle");
  const ImageAccuracy found = measure(render(scene), reference.value().image);
  const bool fast = GetParam().preset == Preset::fast;
  EXPECT_LE(found.bin_rms, fast ? 0.12 : 0.06);
  EXPECT_LE(found.beam_total, fast ? 0.2 : 0.03);
}

}  // namespace
}  // namespace sonard::test
