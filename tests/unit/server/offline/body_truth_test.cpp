// SPDX-License-Identifier: Apache-2.0
// Two blocks before a wall: the body in each bin, by geometry.
#include "server/offline/body_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "renderer/scene/primitives.hpp"

namespace sonard::server {
namespace {

constexpr int range_lines = 200;
constexpr double step_m = 0.05;

/// A square that faces the sonar at the origin. It is `x_m` ahead, from `left_m` to `right_m` (y, port is
/// positive).
render::Body board(const std::string& name, double x_m, double left_m, double right_m) {
  auto mesh = std::make_shared<render::TriangleMesh>();
  const auto x = static_cast<float>(x_m);
  const auto left = static_cast<float>(left_m);
  const auto right = static_cast<float>(right_m);
  mesh->positions = {{x, left, -2}, {x, left, 2}, {x, right, 2}, {x, right, -2}};
  mesh->indices = {0, 1, 2, 0, 2, 3};
  render::Body body;
  body.name = name;
  body.parts.push_back({mesh, {}, {}, nullptr});
  return body;
}

struct BodyTruthTest : testing::Test {
  BodyTruthTest() {
    world.bodies = {board("wall", 8.0, 20.0, -20.0), board("port block", 4.0, 1.5, 0.5),
                    board("starboard block", 5.0, -0.5, -1.5)};
    request.settings.aperture.beam_edges_rad = render::equal_angle_edges(64, 1.0);
    request.settings.aperture.azimuth =
        render::Aperture::Azimuth::array;  // with side lobes, which must not count
    request.settings.range = {range_lines, step_m, 0, false};
  }

  /// The body in the bin at a range, in the beam at an azimuth.
  std::uint16_t at(const std::vector<std::uint16_t>& ids, double range_m, double azimuth_rad) const {
    const auto line = static_cast<std::size_t>(range_m / step_m) >> request.settings.range.compression_log2;
    const auto beam = static_cast<std::size_t>((0.5 - azimuth_rad) * 64);
    return ids[line * 64 + beam];
  }

  render::World world;
  render::PingRequest request;
};

TEST_F(BodyTruthTest, EachBlockIsInItsBinsAndHidesTheWall) {
  BodyTruth truth(world, {});
  const std::vector<std::uint16_t> ids = truth.bodies_in(request);
  const double port_rad = std::atan2(1.0, 4.0);
  const double starboard_rad = std::atan2(-1.0, 5.0);
  EXPECT_EQ(at(ids, 4.0 / std::cos(port_rad) + 0.01, port_rad), 2);
  EXPECT_EQ(at(ids, 5.0 / std::cos(starboard_rad) + 0.01, starboard_rad), 3);
  EXPECT_EQ(at(ids, 8.01, 0.0), 1);                                   // the wall between the blocks
  EXPECT_EQ(at(ids, 8.0 / std::cos(port_rad) + 0.01, port_rad), 0);   // the wall in a block's shadow
  EXPECT_EQ(at(ids, 3.0, port_rad), 0);                               // water
  EXPECT_EQ(at(ids, 4.0 / std::cos(port_rad) + 0.01, -port_rad), 0);  // the other side
}

TEST_F(BodyTruthTest, EachDirectionHasTheBodyBeforeIt) {
  render::DirectionGrid& grid = request.settings.directions;
  grid.columns = 65;
  grid.rows = 5;
  grid.azimuth_fov_rad = 1.0;
  grid.elevation_fov_rad = 0.2;
  grid.azimuth_beamwidth_rad = grid.elevation_beamwidth_rad = 0.01;
  request.settings.aperture = direction_aperture(grid);
  request.settings.model = render::Model::physical;
  world.bodies[0] = board("wall", 8.0, 20.0, -1.0);  // ends to starboard
  BodyTruth truth(world, {});
  const std::vector<std::uint16_t> ids = truth.bodies_in(request);
  ASSERT_EQ(ids.size(), 325U);
  const auto at_azimuth = [&](double azimuth_rad, int row) {
    return ids[static_cast<std::size_t>(65 * row + std::lround((0.5 - azimuth_rad) * 64))];
  };
  for (int row = 0; row < 5; ++row) {
    EXPECT_EQ(at_azimuth(std::atan2(1.0, 4.0), row), 2);
    EXPECT_EQ(at_azimuth(std::atan2(-1.0, 5.0), row), 3);
    EXPECT_EQ(at_azimuth(0.0, row), 1);
    EXPECT_EQ(at_azimuth(-0.45, row), 0) << "water";
  }
}

TEST_F(BodyTruthTest, FollowsABodyThatMovesAndLeavesOutOneWithoutParts) {
  world.bodies[2].parts.clear();
  BodyTruth truth(world, {});
  const double port_rad = std::atan2(1.0, 4.0);
  EXPECT_EQ(at(truth.bodies_in(request), 4.0 / std::cos(port_rad) + 0.01, port_rad), 2);
  truth.set_body_pose("port block", {{1, 0, 0}, {1, 0, 0, 0}});
  const std::vector<std::uint16_t> ids = truth.bodies_in(request);
  const double moved_rad = std::atan2(1.0, 5.0);
  EXPECT_EQ(at(ids, 5.0 / std::cos(moved_rad) + 0.01, moved_rad), 2);
  EXPECT_EQ(at(ids, 4.0 / std::cos(moved_rad) + 0.01, moved_rad), 0);
  EXPECT_EQ(at(ids, 8.0 / std::cos(moved_rad) + 0.01, -moved_rad), 1) << "nothing is before the wall there";
}

// The sonar turns to port by 0.3 rad in the listening time of 10 m. It has turned by a share of this when an
// echo from 4 m is back, so the block appears that much further to starboard, as in the image.
TEST_F(BodyTruthTest, FollowsTheMotionOfTheSonarWithinThePing) {
  const auto mean_azimuth_rad = [&](const std::vector<std::uint16_t>& ids) {
    double sum = 0;
    int count = 0;
    for (std::size_t bin = 0; bin < ids.size(); ++bin) {
      if (ids[bin] == 2) {
        sum += 0.5 - (static_cast<double>(bin % 64) + 0.5) / 64;
        ++count;
      }
    }
    return sum / count;
  };
  BodyTruth truth(world, {});
  const double port_rad = std::atan2(1.0, 4.0);
  EXPECT_NEAR(mean_azimuth_rad(truth.bodies_in(request)), port_rad, 0.012) << "a beam is 0.016 wide";
  const double turn_rad = 0.3;
  request.T_world_sonar_at_end = {{0, 0, 0}, {std::cos(turn_rad / 2), 0, 0, std::sin(turn_rad / 2)}};
  const double block_m = 4.0 / std::cos(port_rad);
  EXPECT_NEAR(mean_azimuth_rad(truth.bodies_in(request)),
              port_rad - turn_rad * block_m / (range_lines * step_m), 0.012);
}

TEST_F(BodyTruthTest, CompressedLinesBelongToWhatLiesInThem) {
  request.settings.range.compression_log2 = 2;
  BodyTruth truth(world, {});
  const std::vector<std::uint16_t> ids = truth.bodies_in(request);
  ASSERT_EQ(ids.size(), 50U * 64U);
  const double port_rad = std::atan2(1.0, 4.0);
  EXPECT_EQ(at(ids, 4.0 / std::cos(port_rad) + 0.01, port_rad), 2);
  EXPECT_EQ(at(ids, 8.01, 0.0), 1);
}

/// A box, turned by yaw and then by pitch.
struct Box {
  glm::dvec3 size_m, centre_m;
  double yaw_rad = 0.0, pitch_rad = 0.0;

  render::Pose pose() const {
    return {centre_m,
            glm::angleAxis(yaw_rad, glm::dvec3(0, 0, 1)) * glm::angleAxis(pitch_rad, glm::dvec3(0, 1, 0))};
  }
  render::Body body() const {
    render::Body body;
    body.name = "box";
    body.parts.push_back({std::make_shared<render::TriangleMesh>(render::make_box(size_m)), {}, {}, nullptr});
    body.T_world_body = pose();
    return body;
  }
};

/// The ranges in each beam of all faces of a box that face the sonar at the origin.
class RangesOfBox {
 public:
  struct Span {
    double low_m = std::numeric_limits<double>::infinity(), high_m = 0.0;
  };

  RangesOfBox(const Box& box, int beams, double fan_rad)
      : fan_rad_(fan_rad), spans_(static_cast<std::size_t>(beams)) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const double side : {-0.5, 0.5}) {
        add_face(box, axis, side);
      }
    }
  }

  const Span& operator[](int beam) const { return spans_[static_cast<std::size_t>(beam)]; }

 private:
  /// Adds points of a face, a few tenths of a millimetre apart at its edges and millimetres inside.
  void add_face(const Box& box, int axis, double side) {
    glm::dvec3 normal(0.0);
    normal[axis] = side;
    const render::Pose pose = box.pose();
    if (glm::dot(pose.orientation * normal, pose * (normal * box.size_m)) >= 0) {
      return;
    }
    const auto add = [&](double u, double v) {
      glm::dvec3 point;
      point[axis] = side;
      point[(axis + 1) % 3] = u - 0.5;
      point[(axis + 2) % 3] = v - 0.5;
      add_point(pose * (point * box.size_m));
    };
    constexpr int steps = 20'000, steps_inside = 1'000;
    for (int i = 0; i <= steps; ++i) {
      const double at = static_cast<double>(i) / steps;
      for (const double end : {0.0, 1.0}) {
        add(at, end);
        add(end, at);
      }
    }
    for (int i = 0; i <= steps_inside; ++i) {
      for (int k = 0; k <= steps_inside; ++k) {
        add(static_cast<double>(i) / steps_inside, static_cast<double>(k) / steps_inside);
      }
    }
  }

  void add_point(const glm::dvec3& point) {
    const double place = (0.5 - std::atan2(point.y, point.x) / fan_rad_) * static_cast<double>(spans_.size());
    if (place >= 0 && place < static_cast<double>(spans_.size())) {
      Span& span = spans_[static_cast<std::size_t>(place)];
      span.low_m = std::min(span.low_m, glm::length(point));
      span.high_m = std::max(span.high_m, glm::length(point));
    }
  }

  double fan_rad_;
  std::vector<Span> spans_;
};

// The facets of a box end in the middle of beams and slices, and their echo must not lead beyond their
// corners.
TEST_F(BodyTruthTest, AMaskEndsWithItsBody) {
  constexpr double fine_step_m = 0.005;
  constexpr double off_m = 0.002;  // of the points of RangesOfBox
  request.settings.range = {2000, fine_step_m, 0, false};
  const std::vector<Box> boxes{{{0.2, 0.2, 2}, {6, 1, 0}, 0.3, 0.5},
                               {{1, 1, 1}, {5, -0.5, -0.4}, 0.7, 0.4},
                               {{1, 1, 1}, {5, 0.3, -0.2}, 0.2, 0.1},
                               {{3, 2, 0.1}, {5, 0.4, -1}, 0.2, 0.3}};
  for (const Box& box : boxes) {
    world.bodies = {box.body()};
    const RangesOfBox ranges(box, 64, 1.0);
    for (const auto preset : {render::Sampling::Preset::fast, render::Sampling::Preset::normal}) {
      request.settings.sampling.preset = preset;
      const std::vector<std::uint16_t> ids = BodyTruth(world, {}).bodies_in(request);
      EXPECT_GT(std::ranges::count(ids, 1), 300);
      for (int bin = 0; bin < static_cast<int>(ids.size()); ++bin) {
        if (ids[static_cast<std::size_t>(bin)] == 1) {
          const double low_m = bin / 64 * fine_step_m;
          const RangesOfBox::Span& span = ranges[bin % 64];
          EXPECT_GT(low_m + fine_step_m, span.low_m - off_m) << "beam " << bin % 64;
          EXPECT_LT(low_m, span.high_m + off_m) << "beam " << bin % 64;
        }
      }
    }
  }
}

// A box within the fan, turned and upright: its mask has no gaps.
TEST_F(BodyTruthTest, AMaskHasAllBinsOfItsBody) {
  constexpr double fine_step_m = 0.005;
  request.settings.range = {2000, fine_step_m, 0, false};
  const Box box{{1, 1, 1}, {5, 0.3, -0.2}, 0.5, 0.0};
  world.bodies = {box.body()};
  const std::vector<std::uint16_t> ids = BodyTruth(world, {}).bodies_in(request);
  const RangesOfBox ranges(box, 64, 1.0);
  int lacking = 0;
  for (int bin = 0; bin < static_cast<int>(ids.size()); ++bin) {
    const double low_m = bin / 64 * fine_step_m;
    const bool within = low_m > ranges[bin % 64].low_m && low_m + fine_step_m < ranges[bin % 64].high_m;
    lacking += within && ids[static_cast<std::size_t>(bin)] == 0 ? 1 : 0;
  }
  EXPECT_EQ(lacking, 0);
}

TEST_F(BodyTruthTest, IdsAreOfEightBitsWhereTheyFit) {
  EXPECT_EQ(BodyTruth(world, {}).table(1, 3, {0, 3, 1}), (npy::Table{1, 3, {0, 3, 1}, {}}));
  world.bodies.resize(256, world.bodies[0]);
  EXPECT_EQ(BodyTruth(world, {}).table(1, 2, {0, 256}), (npy::Table{1, 2, {}, {0, 256}}));
}

TEST_F(BodyTruthTest, NamesBodiesInTheOrderOfTheirIds) {
  EXPECT_EQ(BodyTruth(world, {}).bodies(),
            (std::vector<std::string>{"wall", "port block", "starboard block"}));
}

}  // namespace
}  // namespace sonard::server
