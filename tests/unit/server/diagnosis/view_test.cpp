// SPDX-License-Identifier: Apache-2.0
// The direction in which a sonar looks, and its window on a level bed in closed form: a beam of width b that
// points down by t meets a bed h below it from h / sin(t + b/2) to h / sin(t - b/2).
#include "server/diagnosis/view.hpp"

#include <cmath>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

namespace sonard::server {
namespace {

/// A pose turned about fixed x, y, z by degrees, like a mount.
render::Pose mount(double roll_deg, double pitch_deg, double yaw_deg) {
  const glm::dvec3 z(0, 0, 1), y(0, 1, 0), x(1, 0, 0);
  return {{0, 0, 0},
          glm::angleAxis(glm::radians(yaw_deg), z) * glm::angleAxis(glm::radians(pitch_deg), y) *
              glm::angleAxis(glm::radians(roll_deg), x)};
}

TEST(Looks, SaysWhereTheAxisPoints) {
  EXPECT_EQ(looks_text(mount(0, 0, 0)), "forward");
  EXPECT_EQ(looks_text(mount(0, 20, 0)), "forward and 20 degrees down");
  EXPECT_EQ(looks_text(mount(0, -12, 30)), "30 degrees to port and 12 degrees up");
  EXPECT_EQ(looks_text(mount(0, 0, -90)), "to starboard");
  EXPECT_EQ(looks_text(mount(0, 0, 180)), "aft");
  EXPECT_EQ(looks_text(mount(0, 90, 0)), "straight down");
  EXPECT_EQ(looks_text(mount(0, -90, 0)), "straight up");
  EXPECT_EQ(looks_text(mount(90, 0, 0)), "forward, rolled by 90 degrees");
  EXPECT_EQ(looks_text(mount(180, 0, 0)), "forward, upside down");
  EXPECT_EQ(looks_text(mount(0, 1.57, 0)), "forward and 2 degrees down") << "radians given for degrees";
}

/// A square of 2 km at z = -20 whose front is its upper side, with 800 triangles.
render::World level_bed() {
  auto mesh = std::make_shared<render::TriangleMesh>();
  constexpr int cells = 20;
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      mesh->positions.emplace_back(100 * i - 1000, 100 * j - 1000, 0);
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t a = i * (cells + 1) + j;
      const std::uint32_t b = a + cells + 1;
      for (const std::uint32_t corner : {a, b, b + 1, a, b + 1, a + 1}) {
        mesh->indices.push_back(corner);
      }
    }
  }
  render::World world;
  world.bodies = {{"seabed", {{0, 0, -20}, {1, 0, 0, 0}}, {{mesh, {}, {}, nullptr}}}};
  return world;
}

render::Aperture four_beams() {
  render::Aperture aperture;
  aperture.vertical_beamwidth_rad = glm::radians(20.0);
  aperture.beam_edges_rad = render::equal_angle_edges(4, glm::radians(120.0));
  return aperture;
}

std::optional<BedView> view(const render::Pose& turn, double z_m, double range_m) {
  return view_of_bed(level_bed(), {}, "", {{3, -7, z_m}, turn.orientation}, four_beams(), range_m);
}

TEST(BedWindow, IsWhereTheBeamMeetsIt) {
  // 10 m above the bed and 20 degrees down: from 10 / sin 30 = 20 m to 10 / sin 10 = 57.6 m.
  const auto seen = view(mount(0, 20, 0), -10, 100);
  ASSERT_TRUE(seen && seen->nearest_m);
  EXPECT_EQ(seen->body, "seabed");
  EXPECT_NEAR(seen->below_m, 10.0, 1e-6);
  EXPECT_NEAR(*seen->nearest_m, 20.0, 1e-3);
  EXPECT_NEAR(*seen->farthest_m, 10.0 / std::sin(glm::radians(10.0)), 1e-3);
  EXPECT_EQ(bed_text(seen, 100), "the bed below ('seabed') is visible from 20 to 57.6 m");
}

TEST(BedWindow, EndsWithTheRange) {
  const auto seen = view(mount(0, 20, 0), -10, 40);
  EXPECT_NEAR(*seen->nearest_m, 20.0, 1e-3);
  EXPECT_NEAR(*seen->farthest_m, 40.0, 1e-9);
}

TEST(BedWindow, OfALevelBeamBeginsAtItsLowerEdge) {
  // The lower edge meets the bed at 10 / sin 10.
  EXPECT_NEAR(*view(mount(0, 0, 0), -10, 100)->nearest_m, 10.0 / std::sin(glm::radians(10.0)), 1e-3);
  const auto beyond = view(mount(0, 0, 0), -10, 50);
  ASSERT_TRUE(beyond);
  EXPECT_FALSE(beyond->nearest_m);
  EXPECT_EQ(bed_text(beyond, 50),
            "the bed below ('seabed', 10 m down) is outside the beam (-3 dB) within 50 m");
}

TEST(BedWindow, StraightDownItBeginsAtTheFoot) {
  const auto seen = view(mount(0, 90, 0), -10, 100);
  EXPECT_NEAR(*seen->nearest_m, 10.0, 1e-4);
  EXPECT_NEAR(*seen->farthest_m, 10.0 / std::cos(glm::radians(10.0)), 1e-3);
}

TEST(BedWindow, AFanOnItsSideSeesTheFootByItsBeams) {
  // Rolled by 90 degrees, the beams reach to 60 degrees below the horizontal, so the bed begins at 10 / sin
  // 60.
  EXPECT_NEAR(*view(mount(90, 0, 0), -10, 100)->nearest_m, 10.0 / std::sin(glm::radians(60.0)), 1e-3);
}

TEST(BedWindow, WithTheBackToTheBedThereIsNone) {
  const auto seen = view(mount(0, -45, 0), -10, 100);
  ASSERT_TRUE(seen);
  EXPECT_FALSE(seen->nearest_m);
}

TEST(BedWindow, BelowTheBedNothingIsBelow) {
  EXPECT_FALSE(view(mount(0, 20, 0), -21, 100));
  EXPECT_EQ(bed_text({}, 100), "nothing is below it");
  EXPECT_FALSE(view_of_bed(level_bed(), {}, "seabed", {{0, 0, -10}, {1, 0, 0, 0}}, four_beams(), 50));
}

/// One body: a floor at z = -20, and a wall at x = 18 from the floor up to z = 0.
render::World tank() {
  render::World world = level_bed();
  auto mesh = std::make_shared<render::TriangleMesh>(*world.bodies[0].parts[0].mesh);
  const auto first = static_cast<std::uint32_t>(mesh->positions.size());
  for (const glm::vec3& corner : {glm::vec3(18, 50, 0), {18, -50, 0}, {18, -50, 20}, {18, 50, 20}}) {
    mesh->positions.push_back(corner);
  }
  for (const std::uint32_t corner : {2U, 1U, 0U, 3U, 2U, 0U}) {  // its front faces -x
    mesh->indices.push_back(first + corner);
  }
  world.bodies[0].parts[0].mesh = mesh;
  return world;
}

TEST(BedWindow, IsNotAWallOfTheSameBody) {
  // The wall is 15 m away. The floor is 10 m below and begins at 10 / sin 10 = 57.6 m.
  const render::Pose level{{3, -7, -10}, mount(0, 0, 0).orientation};
  EXPECT_FALSE(view_of_bed(tank(), {}, "", level, four_beams(), 40)->nearest_m);
  EXPECT_NEAR(*view_of_bed(tank(), {}, "", level, four_beams(), 100)->nearest_m,
              10.0 / std::sin(glm::radians(10.0)), 1e-3);
}

TEST(BedWindow, FollowsABodyThatHasMoved) {
  const auto seen = view_of_bed(level_bed(), {{"seabed", {{0, 0, -15}, {1, 0, 0, 0}}}}, "",
                                {{3, -7, -10}, mount(0, 20, 0).orientation}, four_beams(), 100);
  EXPECT_NEAR(*seen->nearest_m, 10.0, 1e-3);  // 5 / sin 30
}

}  // namespace
}  // namespace sonard::server
