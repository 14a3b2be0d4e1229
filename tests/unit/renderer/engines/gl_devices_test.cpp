// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gl_devices.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/errors.hpp"

namespace sonard::render {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Renderer strings as drivers give them.
const GlDevice software{"Mesa / llvmpipe (LLVM 15.0.6, 256 bits) / 4.5 Mesa 22.3.6", "", true, 0};
const GlDevice intel{"Intel / Mesa Intel(R) UHD Graphics 620 (KBL GT2) / 4.6 Mesa 22.3.6", "/dev/dri/card0"};
const GlDevice nvidia{"NVIDIA Corporation / NVIDIA GeForce RTX 3060/PCIe/SSE2 / 4.6.0 NVIDIA 525.85",
                      "/dev/dri/card1", false, 12288};
const GlDevice none{"", "/dev/dri/card2"};

std::size_t best_of(const std::vector<GlDevice>& devices) {
  return choose_gl_device(devices, "").number;
}

std::string complaint(const std::vector<GlDevice>& devices, const std::string& wanted) {
  try {
    choose_gl_device(devices, wanted);
  } catch (const RendererError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(GlDevices, HardwareComesBeforeSoftwareThenMostMemoryThenTheirOrder) {
  EXPECT_EQ(best_of({software}), 0U);
  EXPECT_EQ(best_of({software, intel}), 1U);
  EXPECT_EQ(best_of({intel, nvidia, software}), 1U);
  EXPECT_EQ(best_of({nvidia, intel}), 0U);
  EXPECT_EQ(best_of({intel, intel}), 0U);
  EXPECT_EQ(best_of({none, software}), 1U);
}

TEST(GlDevices, TheChoiceSaysWhy) {
  EXPECT_EQ(choose_gl_device({software}, "").reason, "the only device");
  EXPECT_EQ(choose_gl_device({software, intel}, "").reason, "the only hardware device");
  EXPECT_EQ(choose_gl_device({intel, nvidia}, "").reason, "most memory");
  EXPECT_EQ(choose_gl_device({intel, intel}, "").reason, "the first device listed by EGL");
  EXPECT_EQ(choose_gl_device({intel, nvidia}, "0").reason, "gpu.device selects its number");
}

TEST(GlDevices, AreAskedForByNumberOrByPartOfTheName) {
  EXPECT_EQ(choose_gl_device({nvidia, software}, "1").number, 1U);
  EXPECT_EQ(choose_gl_device({nvidia, software}, "LLVMPIPE").number, 1U);
  EXPECT_EQ(choose_gl_device({intel, nvidia}, "rtx 3060").number, 1U);
}

TEST(GlDevices, WhatIsNotThereIsToldWithWhatIs) {
  EXPECT_THAT(complaint({}, ""), HasSubstr("no OpenGL 4.5 through EGL: EGL lists no device"));
  EXPECT_THAT(complaint({none}, ""), HasSubstr("0: no OpenGL 4.5, /dev/dri/card2"));
  EXPECT_THAT(complaint({none, software}, "0"), HasSubstr("gpu.device: no device '0' with OpenGL 4.5"));
  EXPECT_THAT(complaint({software}, "1"), HasSubstr("found 0: Mesa / llvmpipe"));
  EXPECT_THAT(complaint({software}, "radeon"), HasSubstr("'radeon'"));
}

// Renderer names of Mesa and ANGLE, and of two GPUs.
TEST(GlDevices, SoftwareIsKnownByItsName) {
  EXPECT_TRUE(is_software_renderer(software.description));
  EXPECT_TRUE(is_software_renderer("Mesa/X.org / softpipe / 3.3 (Compatibility Profile) Mesa 22.3.6"));
  EXPECT_TRUE(is_software_renderer("Mesa Project / Software Rasterizer / 2.1 Mesa 20.3.5"));
  EXPECT_TRUE(is_software_renderer("Google Inc. / ANGLE (SwiftShader Device (Subzero)) / 3.0"));
  EXPECT_FALSE(is_software_renderer(intel.description));
  EXPECT_FALSE(is_software_renderer(nvidia.description));
}

TEST(GlDevices, ALineSaysWhatADeviceIs) {
  EXPECT_THAT(describe({nvidia, software}),
              ElementsAre("0: NVIDIA Corporation / NVIDIA GeForce RTX 3060/PCIe/SSE2 / 4.6.0 NVIDIA 525.85, "
                          "/dev/dri/card1, 12288 MiB",
                          "1: Mesa / llvmpipe (LLVM 15.0.6, 256 bits) / 4.5 Mesa 22.3.6, software"));
}

}  // namespace
}  // namespace sonard::render
