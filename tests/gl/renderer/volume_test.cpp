// SPDX-License-Identifier: Apache-2.0
// Volume reverberation (docs/physics.md 2.10): closed forms, and surfaces that hide water.
#include <cmath>
#include <numbers>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::EngineTest;
using test::make_body;
using test::make_quad;
using test::make_world;

constexpr double scattering_db = -60;
constexpr int beam_count = 32;

PingRequest turbid_request(Aperture::Elevation elevation = Aperture::Elevation::top_hat) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(beam_count, 80 * degree);
  request.settings.aperture.elevation = elevation;
  request.settings.range = {600, 0.05, 0, false};
  request.settings.physical.volume_scattering_db = scattering_db;
  request.settings.physical.absorption_db_per_m = 0.2;
  return request;
}

/// A quad that returns no echo itself.
Body screen(const glm::dvec3& corner, const glm::dvec3& along, const glm::dvec3& up) {
  return make_body("screen", make_quad(corner, along, up), 0.0);
}

/// s_v times the open solid angle of a beam times dr r^-2 10^(-alpha r / 5), in the middle of a line.
double expected_echo(const PingRequest& request, double open_sr, int line) {
  const RangeBins& range = request.settings.range;
  const double range_m = (line + 0.5) * range.step_m;
  return std::pow(10.0, request.settings.physical.volume_scattering_db / 10) * open_sr * range.step_m /
         (range_m * range_m) * std::pow(10.0, -request.settings.physical.absorption_db_per_m * range_m / 5);
}

/// Solid angle of a beam without an elevation pattern.
double beam_sr(double low_rad, double high_rad) {
  return 80 * degree / beam_count * (std::sin(high_rad) - std::sin(low_rad));
}

void expect_level(const EchoImage& image, int beam, int line, double expected) {
  EXPECT_NEAR(static_cast<double>(image.at(beam, line)) / expected, 1, 2e-3) << beam << ' ' << line;
}

class VolumeReverberation : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, VolumeReverberation, test::all_engines(), test::engine_name);

TEST_P(VolumeReverberation, FillsEmptyWaterByItsClosedForm) {
  SonarRenderer renderer(World{}, options());
  const PingRequest request = turbid_request();
  const EchoImage& image = renderer.render_echo(request);
  for (const int beam : {0, 5, 16, 31}) {
    for (const int line : {0, 1, 20, 300, 599}) {
      expect_level(image, beam, line, expected_echo(request, beam_sr(-10 * degree, 10 * degree), line));
    }
  }
}

TEST_P(VolumeReverberation, WeighsTheWaterWithTheElevationPattern) {
  const PingRequest request = turbid_request(Aperture::Elevation::sinc);
  // docs/physics.md 2.5: sinc^2(0.443 sin theta / sin 10 degrees), to 1.25 beamwidths on either side.
  double height = 0;
  constexpr int steps = 20'000;
  for (int i = 0; i < steps; ++i) {
    const double theta = 25 * degree * (2 * (i + 0.5) / steps - 1);
    const double x = std::numbers::pi * 0.443 * std::sin(theta) / std::sin(10 * degree);
    height += std::pow(std::sin(x) / x, 2) * std::cos(theta) * 50 * degree / steps;
  }
  SonarRenderer renderer(World{}, options());
  const EchoImage& image = renderer.render_echo(request);
  expect_level(image, 16, 300, expected_echo(request, 80 * degree / beam_count * height, 300));
}

TEST_P(VolumeReverberation, EndsBehindAWall) {
  SonarRenderer renderer(make_world({screen({10, -40, -40}, {0, 80, 0}, {0, 0, 80})}), options());
  for (const auto elevation : {Aperture::Elevation::top_hat, Aperture::Elevation::sinc}) {
    const PingRequest request = turbid_request(elevation);
    const EchoImage& image = renderer.render_echo(request);
    const auto& edges = request.settings.aperture.beam_edges_rad;
    for (const int beam : {0, 9, 16, 31}) {
      const auto b = static_cast<std::size_t>(beam);
      const double nearest = std::min(std::abs(edges[b]), std::abs(edges[b + 1]));
      const double farthest = std::max(std::abs(edges[b]), std::abs(edges[b + 1]));
      const double limit = request.settings.aperture.elevation_limit_rad();
      const int before = static_cast<int>(10 / std::cos(nearest) / 0.05) - 2;
      const int behind = static_cast<int>(10 / std::cos(farthest) / std::cos(limit) / 0.05) + 2;
      EXPECT_GT(image.at(beam, before), 0.0F);
      for (int line = behind; line < image.bins; ++line) {
        ASSERT_EQ(image.at(beam, line), 0.0F) << beam << ' ' << line;
      }
    }
  }
}

TEST_P(VolumeReverberation, GoesOnOverAWallThatHidesALowerPart) {
  // Up to the plane of the sonar: the lower half of the fan is blocked.
  SonarRenderer renderer(make_world({screen({6, -40, -40}, {0, 80, 0}, {0, 0, 40})}), options());
  const PingRequest request = turbid_request();
  const EchoImage& image = renderer.render_echo(request);
  for (const int beam : {0, 16, 31}) {
    expect_level(image, beam, 60, expected_echo(request, beam_sr(-10 * degree, 10 * degree), 60));
    expect_level(image, beam, 400, expected_echo(request, beam_sr(0, 10 * degree), 400));
  }
}

TEST_P(VolumeReverberation, IsNotHiddenInTheBeamsBesideAWall) {
  SonarRenderer renderer(make_world({screen({6, 0, -40}, {0, 40, 0}, {0, 0, 80})}), options());
  const PingRequest request = turbid_request();
  const EchoImage& image = renderer.render_echo(request);
  EXPECT_EQ(image.at(beam_count / 2 - 1, 400), 0.0F);
  expect_level(image, beam_count / 2, 400, expected_echo(request, beam_sr(-10 * degree, 10 * degree), 400));
}

TEST_P(VolumeReverberation, ActsAtAnyRangeAndStrengthThatIsSet) {
  SonarRenderer renderer(World{}, options());
  PingRequest request = turbid_request();
  request.settings.range.step_m = 10.0 / 600;
  request.settings.physical.volume_scattering_db = -90.0;
  const EchoImage& image = renderer.render_echo(request);
  for (const int line : {50, 200, 590}) {
    expect_level(image, 3, line, expected_echo(request, beam_sr(-10 * degree, 10 * degree), line));
  }
}

TEST_P(VolumeReverberation, IsOffUnlessAskedFor) {
  SonarRenderer renderer(World{}, options());
  PingRequest request = turbid_request();
  request.settings.physical.volume_scattering_db = PhysicalModel().volume_scattering_db;
  for (const float intensity : renderer.render_echo(request).intensity) {
    ASSERT_EQ(intensity, 0.0F);
  }
  request.settings.physical.volume_scattering_db = scattering_db;
  EXPECT_GT(renderer.render_echo(request).at(3, 300), 0.0F) << "a change of it makes a new echo";
}

}  // namespace
}  // namespace sonard::render
