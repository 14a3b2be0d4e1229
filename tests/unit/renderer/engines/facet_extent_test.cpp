// SPDX-License-Identifier: Apache-2.0
// The ranges of one triangle in a wedge, by the right triangles of its corners.
#include "renderer/engines/cpu/facet_extent.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

FanTriangle triangle_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  FanTriangle triangle{};
  const glm::vec3* const corners[]{&a, &b, &c};
  for (std::size_t k = 0; k < 3; ++k) {
    triangle.x[k] = corners[k]->x;
    triangle.y[k] = corners[k]->y;
    triangle.z[k] = corners[k]->z;
  }
  return triangle;
}

TEST(FacetExtent, OfATriangleAroundTheAxisBeginsAtItsFootPoint) {
  const auto extent = facet_extent(triangle_of({3, -4, -1}, {3, 4, -1}, {3, 0, 5}), {0.0, 3.0F});
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->nearest_m, 3.0, 1e-6);
  EXPECT_NEAR(extent->furthest_m, std::sqrt(9.0 + 25), 1e-6);
}

TEST(FacetExtent, OfAWedgeEndsAtItsSides) {
  // The wedge from 10 to 20 degrees, on a plane 3 m ahead: all corners of the triangle are outside.
  constexpr double degree = 0.017453292519943295;
  const Slice wedge(15 * degree, static_cast<float>(10 * degree));
  for (const bool turned : {false, true}) {
    const glm::vec3 low{3, -4, -1}, high{3, 4, -1}, top{3, 0.7F, 1};
    const auto extent =
        facet_extent(turned ? triangle_of(low, top, high) : triangle_of(low, high, top), wedge);
    ASSERT_TRUE(extent);
    EXPECT_NEAR(extent->nearest_m, 3 / std::cos(10 * degree), 1e-5);
    // Its furthest point is on its lower edge, at the port side.
    EXPECT_NEAR(extent->furthest_m, std::hypot(3 / std::cos(20 * degree), 1.0), 1e-5);
  }
}

TEST(FacetExtent, OfATriangleBesideTheWedgeIsNone) {
  EXPECT_FALSE(facet_extent(triangle_of({3, 1, 0}, {3, 2, 0}, {3, 1, 1}), {0.0, 0.1F}));
}

TEST(KeepWithin, APatchInsideStaysAsItIs) {
  EchoPatch patch{4.0F, 4.5F, 0.1F, 0.2F, 1.0F, 2.0F, 0.3F, 0.4F, 0.0F, 0.1F};
  keep_within({3.9F, 4.7F}, patch);
  EXPECT_NEAR(patch.range_a_m, 4.0F, 1e-6F);
  EXPECT_NEAR(patch.smear_b_m, 0.2F, 1e-6F);
  EXPECT_FLOAT_EQ(patch.echo_gradient, 0.3F);
}

TEST(KeepWithin, WhatLeadsBeyondIsCutOffAndEndsDoNotCross) {
  EchoPatch patch{4.0F, 4.5F, 0.4F, 0.4F, 1.0F, 2.0F, 0.0F, 0.0F, 0.0F, 0.1F};
  keep_within({3.9F, 4.6F}, patch);
  EXPECT_FLOAT_EQ(patch.range_a_m - 0.5F * patch.smear_a_m, 3.9F);
  EXPECT_FLOAT_EQ(patch.range_a_m + 0.5F * patch.smear_a_m, 4.2F);
  EXPECT_FLOAT_EQ(patch.range_b_m + 0.5F * patch.smear_b_m, 4.6F);
  // Ends at nearly one range with unequal smears become one box over both.
  EchoPatch crossing{4.0F, 4.01F, 0.1F, 0.6F, 1.0F, 2.0F, 0.5F, 0.5F, 0.0F, 0.1F};
  keep_within({3.9F, 4.2F}, crossing);
  EXPECT_FLOAT_EQ(crossing.range_a_m, crossing.range_b_m);
  EXPECT_FLOAT_EQ(crossing.range_a_m - 0.5F * crossing.smear_a_m, 3.9F);
  EXPECT_FLOAT_EQ(crossing.range_b_m + 0.5F * crossing.smear_b_m, 4.2F);
  EXPECT_EQ(crossing.echo_gradient, 0.0F);
}

}  // namespace
}  // namespace sonard::render
