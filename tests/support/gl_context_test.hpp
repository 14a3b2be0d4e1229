// SPDX-License-Identifier: Apache-2.0
// Fixture for tests that call OpenGL themselves. Without OpenGL they are skipped, as in engine_test.hpp.
#pragma once

#include <gtest/gtest.h>

#include "renderer/engines/gpu/egl_context.hpp"
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

}  // namespace sonard::test
