// SPDX-License-Identifier: Apache-2.0
// Fixture for tests that call OpenGL themselves. Without OpenGL they are skipped, as in engine_test.hpp.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {

class GlContextTest : public ::testing::Test {
 protected:
  void SetUp() override {
    require_gl();
    if (!IsSkipped() && !HasFatalFailure()) {
      context_ = render::EglContext::made_current("");
    }
  }

  osg::ref_ptr<render::EglContext> context_;  ///< current
};

/// The first `count` values of a buffer. Waits for the GPU.
template <class T>
std::vector<T> read_back(osg::GLExtensions& gl, const render::GpuBuffer& buffer, std::size_t count) {
  std::vector<T> values(count);
  gl.glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  render::GpuReadback readback(gl);
  readback.ask({{buffer, count * sizeof(T)}});
  EXPECT_TRUE(readback.wait(
      [&](std::span<const std::byte> bytes) { std::memcpy(values.data(), bytes.data(), bytes.size()); }));
  return values;
}

}  // namespace sonard::test
