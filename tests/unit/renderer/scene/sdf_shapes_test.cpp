// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/sdf_shapes.hpp"

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

SdfElement element_of(const std::string& name, const std::string& key, const std::string& value) {
  SdfElement element;
  element.name = name;
  element.add_child(key, element).text = value;
  return element;
}

TEST(SdfShapes, KnowTheirTrianglesBeforeTheyAreMade) {
  for (const char* name : {"box", "plane", "sphere", "ellipsoid", "cylinder", "cone", "capsule"}) {
    for (const char* size : {"0.01", "1", "7.5", "49"}) {
      const bool is_ellipsoid = std::string(name) == "ellipsoid";
      const SdfElement element =
          element_of(name, is_ellipsoid ? "radii" : "radius",
                     is_ellipsoid ? std::string("1 ") + size + " 2" : std::string(size));
      EXPECT_EQ(primitive_triangles(element), primitive_of(element)->triangle_count()) << name << " " << size;
    }
  }
  for (const char* not_a_size : {"-1", "0", "nan", "inf", "wide"}) {
    EXPECT_EQ(primitive_triangles(element_of("sphere", "radius", not_a_size)), 0U) << not_a_size;
  }
  EXPECT_EQ(primitive_triangles(element_of("mesh", "uri", "hull.stl")), 0U);
}

}  // namespace
}  // namespace sonard::render
