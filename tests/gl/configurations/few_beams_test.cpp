// SPDX-License-Identifier: Apache-2.0
// Both engines make the same image in each scene of configs/: a few beams, at the first pose.
#include <gtest/gtest.h>

#include "tests/gl/configurations/config_scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

TEST(ConfigScenes, EnginesAgreeInAFewBeams) {
  const ConfigScenes all = config_scenes(0, 4);  // before OpenGL has threads
  require_gl();
  if (!IsSkipped() && !HasFatalFailure()) {
    expect_agreement(all, 2);
  }
}

}  // namespace
}  // namespace sonard::test
