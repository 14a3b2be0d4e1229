// SPDX-License-Identifier: Apache-2.0
// All worlds in configs/worlds load without warnings, repairs or dropped triangles.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/world.hpp"

namespace sonard::render {
namespace {

TEST(ShippedWorlds, LoadWhole) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(SONARD_SOURCE_DIR "/configs/worlds")) {
    if (entry.path().extension() != ".sdf") {
      continue;
    }
    SCOPED_TRACE(entry.path());
    ++files;
    const World world = load_world(entry.path(), {});
    EXPECT_EQ(world.name, entry.path().stem().string());
    EXPECT_EQ(world.water_surface_z_m, 0.0);
    EXPECT_THAT(world.warnings, testing::IsEmpty());
    const MeshDiagnostics& repaired = world.diagnostics;
    EXPECT_EQ(repaired.degenerate_triangles + repaired.non_finite_triangles, 0U);
    EXPECT_EQ(repaired.bad_normals + repaired.bad_texcoords, 0U);
  }
  EXPECT_GE(files, 5);
}

}  // namespace
}  // namespace sonard::render
