// SPDX-License-Identifier: Apache-2.0
// Views of two squares at known places.
#include "server/web/world_view.hpp"

#include <memory>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace sonard::server {
namespace {

/// A square of 2 m in the x-y plane, of two triangles, with its middle at (5, 1, -3).
render::Body square() {
  auto mesh = std::make_shared<render::TriangleMesh>();
  mesh->positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  return {"square", {{5, 1, -3}, {1, 0, 0, 0}}, {{mesh, {}, {}, nullptr}}};
}

/// The square, and a second one 4 m further east, so that the picture has a gap in the middle.
render::World two_squares() {
  render::World world;
  world.name = "squares";
  world.bodies = {square(), square()};
  world.bodies[1].name = "other";
  world.bodies[1].T_world_body.position_m.x = 9;
  return world;
}

TEST(WorldView, SaysWhereBodiesAre) {
  const nlohmann::json world = world_json(two_squares());
  EXPECT_EQ(world["extent_m"]["min"], (nlohmann::json{4.0, 0.0, -3.0}));
  EXPECT_EQ(world["extent_m"]["max"], (nlohmann::json{10.0, 2.0, -3.0}));
  EXPECT_EQ(world["bodies"][0]["triangles"], 2);
  EXPECT_EQ(world["bodies"][0]["top"], (nlohmann::json{{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}));
  EXPECT_EQ(world["bodies"][0]["side"], (nlohmann::json{{-1.0, 0.0}, {1.0, 0.0}}));
  EXPECT_EQ(world["water_surface_z_m"], nullptr);
}

TEST(WorldView, ShowsThemInThePictureWhereTheyAre) {
  const std::string png = world_png(two_squares(), ViewFrom::above);
  const std::vector<std::uint8_t> bytes(png.begin(), png.end());
  const cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.channels(), 4);
  ASSERT_EQ(picture.cols, 1024);
  ASSERT_EQ(picture.rows, 341);  // 2 m by 6 m
  const auto alpha = [&](double x_share) {
    return picture.at<cv::Vec4b>(170, static_cast<int>(x_share * 1023))[3];
  };
  EXPECT_EQ(alpha(0.16), 255);  // the first square, 0 to 1/3
  EXPECT_EQ(alpha(0.5), 0);
  EXPECT_EQ(alpha(0.84), 255);
}

}  // namespace
}  // namespace sonard::server
