// SPDX-License-Identifier: Apache-2.0
// Objects thinner than a column of samples, or between two slices, are not lost.
#include "renderer/engines/gpu/thin_things.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/scenes/shapes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// The fine beams of a Gemini: 512, of equal sine.
Aperture fan() {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(512, 60 * degree);
  return aperture;
}

Pose turned(double yaw_rad) {
  return {{0, 0, 0}, glm::angleAxis(yaw_rad, glm::dvec3(0, 0, 1))};
}

/// A post, 30 mm wide and 2 m high.
TriangleMesh post_at(double range_m) {
  return test::make_block({range_m, 0, 0}, {0.03, 0.03, 2}, 0);
}

/// The beams that need more columns.
std::vector<int> beams_with(const std::vector<int>& columns) {
  std::vector<int> beams;
  for (std::size_t beam = 0; beam < columns.size(); ++beam) {
    if (columns[beam] > 0) {
      beams.push_back(static_cast<int>(beam));
    }
  }
  return beams;
}

// A fine beam in the middle is 2 sin 60 / 512 = 3.38 mrad wide, 101 mm at 30 m. The width found for a square
// bar is 30 to 45 mm, so eight columns across it make 18 to 27 columns in the beam.
TEST(ThinThings, EightColumnsLieAcrossAPost) {
  const ThinThings things(test::make_world({test::make_body("post", post_at(30))}));
  ASSERT_EQ(things.all().size(), 1u);
  EXPECT_GE(things.all()[0].width_m, 0.03);
  EXPECT_LE(things.all()[0].width_m, 0.045);
  const std::vector<int> columns = things.least_columns({}, fan(), 50);
  EXPECT_EQ(beams_with(columns), (std::vector<int>{255, 256}));  // it stands between the two
  EXPECT_GE(columns[255], 18);
  EXPECT_LE(columns[255], 28);
  // If the sonar turns 40 degrees to port, the post is to starboard: sin 40 / sin 60 * 256 = 190.01 beams.
  EXPECT_EQ(beams_with(things.least_columns(turned(40 * degree), fan(), 50)), (std::vector<int>{445, 446}));
  EXPECT_TRUE(beams_with(things.least_columns({}, fan(), 25)).empty());
  EXPECT_TRUE(beams_with(things.least_columns(turned(80 * degree), fan(), 50)).empty());
  EXPECT_TRUE(beams_with(things.least_columns(turned(180 * degree), fan(), 50)).empty());
}

TEST(ThinThings, AreFoundInsideOfAMeshAndMoveWithTheirBody) {
  TriangleMesh mesh = test::make_block({20, 0, 0}, {4, 6, 1}, 0);
  test::append(mesh, test::make_tube({10, -1, -1}, {10, -1, 1}, 0.01, 12, 1));  // a post to starboard
  test::append(mesh, test::make_tube({10, 1, -1}, {10, 2, 1}, 0.01, 12, 1));    // a brace to port
  ThinThings things(test::make_world({test::make_body("frame", mesh)}));
  ASSERT_EQ(things.all().size(), 2u);
  for (const ThinThing& thing : things.all()) {
    EXPECT_NEAR(thing.width_m, 0.02, 0.002);
  }
  // atan(1 / 10) is 5.71 degrees, 29.4 beams from the middle; atan(2 / 10) 11.31 degrees, 58.0.
  const std::vector<int> columns = things.least_columns({}, fan(), 30);
  for (int beam = 0; beam < 512; ++beam) {
    const bool inside = (beam >= 198 && beam <= 226) || beam == 285;
    const bool near = (beam >= 196 && beam <= 228) || (beam >= 284 && beam <= 287);
    if (inside || !near) {
      EXPECT_EQ(columns[static_cast<std::size_t>(beam)] > 0, inside) << beam;
    }
  }
  things.set_body_pose(0, {{100, 0, 0}, {1, 0, 0, 0}});
  EXPECT_TRUE(beams_with(things.least_columns({}, fan(), 30)).empty());
}

TEST(ThinThings, WideOnesAreLeftToTheGrid) {
  EXPECT_TRUE(
      ThinThings(test::make_world({test::make_body("box", test::make_block({5, 0, 0}, {1, 1, 1}, 0))}))
          .all()
          .empty());
}

TEST(ThinThings, SayWhereNobodyLooksForThem) {
  const World box = test::make_world({test::make_body("box", test::make_block({5, 0, 0}, {1, 1, 1}, 0))});
  SonarSettings settings;
  EXPECT_EQ(thin_things_not_looked_for(box, settings), "");
  const World many =
      test::make_world({test::make_body("hull", test::make_tube({0, 0, 0}, {0, 0, 1}, 1, 1000, 101))});
  EXPECT_THAT(thin_things_not_looked_for(many, settings),
              testing::HasSubstr("part of 'hull': its mesh has 20"));
  settings.aperture.bearing = Aperture::Bearing::conical;
  EXPECT_THAT(thin_things_not_looked_for(box, settings), testing::HasSubstr("`bearing: conical`"));
  settings.sampling.preset = Sampling::Preset::grid;
  EXPECT_THAT(thin_things_not_looked_for(box, settings), testing::HasSubstr("`sampling: {preset: grid}`"));
}

class ThinPost : public test::EngineTest {};
INSTANTIATE_TEST_SUITE_P(Engines, ThinPost, test::all_engines(), test::engine_name);

// T2 in small: a face of 30 mm by 2 m, 29.985 m away. Its elevations lie well inside the fan, where the
// pattern is 1, so its echo is its area over r^4.
TEST_P(ThinPost, IsInEveryPing) {
  for (const auto& [preset, pings] : {std::pair{Sampling::Preset::fast, 16}, {Sampling::Preset::normal, 4}}) {
    SonarRenderer renderer(test::make_world({test::make_body("post", post_at(30))}), options());
    for (int ping = 0; ping < pings; ++ping) {
      PingRequest request;
      request.settings.aperture = fan();
      request.settings.range = {3600, 0.01, 0, false};
      request.settings.sampling.preset = preset;
      request.settings.physical.absorption_db_per_m = 0;
      request.settings.physical.backscatter = PhysicalModel::Backscatter::lambert;
      // Steps of 0.37 columns of the coarsest grid.
      request.T_world_sonar = turned(ping * 0.37 * 1.69e-3);
      const std::vector<float>& echo = renderer.render_echo(request).intensity;
      const double sum = std::accumulate(echo.begin(), echo.end(), 0.0);
      EXPECT_NEAR(10 * std::log10(sum / (0.03 * 2 / std::pow(29.985, 4))), 0, 1) << ping;
    }
  }
}

// In the one beam of a scanning head, slices are a degree apart: 87 mm at 5 m. The echo of a flat plate of
// 40 mm corresponds to its area at any place in the beam. A second plate in the same mesh behaves alike.
TEST_P(ThinPost, APlateIsInEveryLineOfAScanningHead) {
  constexpr float size_m = 0.04F;
  const auto plate = [](float x, float z) {
    return test::make_quad({x, -size_m / 2, z - size_m / 2}, {0, size_m, 0}, {0, 0, size_m});
  };
  TriangleMesh plates = plate(5, 0);
  test::append(plates, plate(6, 0.6F));
  SonarRenderer renderer(test::make_world({test::make_body("plates", plates)}), options());
  for (int step = -5; step <= 5; ++step) {
    PingRequest request;
    request.settings.aperture.beam_edges_rad = {1.2 * degree, -1.2 * degree};
    request.settings.range = {1000, 0.01, 0, false};
    request.settings.physical.absorption_db_per_m = 0;
    request.settings.physical.backscatter = PhysicalModel::Backscatter::lambert;
    request.T_world_sonar = turned(step * 0.13 * degree);
    const std::vector<float>& echo = renderer.render_echo(request).intensity;
    const double near = std::accumulate(echo.begin(), echo.begin() + 550, 0.0);
    const double far = std::accumulate(echo.begin() + 550, echo.end(), 0.0);
    EXPECT_NEAR(10 * std::log10(near / (0.04 * 0.04 / std::pow(5, 4))), 0, 1) << step;
    // Lambert's law at an incidence of 5.7 degrees, at a distance of 6 m over its cosine.
    const double tilt = std::atan2(0.6, 6);
    const double expected = 0.04 * 0.04 * std::pow(std::cos(tilt), 6) / std::pow(6, 4);
    EXPECT_NEAR(10 * std::log10(far / expected), 0, 1) << step;
  }
}

}  // namespace
}  // namespace sonard::render
