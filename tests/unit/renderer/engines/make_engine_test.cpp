// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/make_engine.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/engines/gpu/egl_context.hpp"

namespace sonard::render {
namespace {

// Renderer strings as drivers give them.
TEST(SoftwareGl, IsToldByItsName) {
  EXPECT_TRUE(is_software_gl("Mesa / llvmpipe (LLVM 15.0.6, 256 bits) / 4.5 (Core Profile) Mesa 22.3.6"));
  EXPECT_TRUE(is_software_gl("Mesa/X.org / softpipe / 3.3 (Compatibility Profile) Mesa 22.3.6"));
  EXPECT_TRUE(is_software_gl("Mesa Project / Software Rasterizer / 2.1 Mesa 10.3"));
  EXPECT_TRUE(is_software_gl("Mesa / zink Vulkan 1.3(llvmpipe (LLVM 15.0.6, 256 bits)) / 4.6 Mesa 23.1"));
  EXPECT_TRUE(is_software_gl("Google Inc. / ANGLE (Google, Vulkan 1.3 (SwiftShader Device)) / 4.5"));
  EXPECT_FALSE(
      is_software_gl("NVIDIA Corporation / NVIDIA GeForce RTX 3060/PCIe/SSE2 / 4.6.0 NVIDIA 525.85"));
  EXPECT_FALSE(is_software_gl("Intel / Mesa Intel(R) UHD Graphics 620 (KBL GT2) / 4.6 Mesa 22.3.6"));
  EXPECT_FALSE(
      is_software_gl("AMD / AMD Radeon RX 580 (polaris10, LLVM 15.0.6, DRM 3.49) / 4.6 Mesa 22.3.6"));
}

TEST(MakeEngine, KeepsWhatIsAskedForByName) {
  WorkerPool workers(1);
  SpatialIndex index(World{}, workers);
  const ChosenEngine chosen = make_engine(index, workers, {EngineKind::cpu});
  EXPECT_EQ(chosen.kind, EngineKind::cpu);
  EXPECT_THAT(chosen.description, testing::MatchesRegex("cpu, Embree 3\\.[0-9.]+, packets of [0-9]+"));
}

TEST(MakeEngine, AutomaticEndsInARealEngineAndSaysWhy) {
  WorkerPool workers(1);
  SpatialIndex index(World{}, workers);
  const ChosenEngine chosen = make_engine(index, workers, {});
  EXPECT_NE(chosen.kind, EngineKind::automatic);
  EXPECT_EQ(chosen.description.rfind(std::string(name_of(chosen.kind)) + ", ", 0), 0U);
  EXPECT_THAT(chosen.description, testing::HasSubstr("; auto found "));
  EXPECT_EQ(chosen.kind == EngineKind::cpu,
            is_software_gl(chosen.description) || chosen.description.find("no OpenGL") != std::string::npos);
}

}  // namespace
}  // namespace sonard::render
