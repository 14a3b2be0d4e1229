// SPDX-License-Identifier: Apache-2.0
// Both engines make the same image in each scene of configs/: 64 beams and whole turns, also in the middle of
// trajectories.
#include <gtest/gtest.h>

#include "tests/gl/configurations/config_scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

TEST(ConfigScenes, EnginesAgreeAlongTrajectories) {
  const ConfigScenes all = config_scenes(1, 40);  // before OpenGL has threads
  require_gl();
  if (!IsSkipped() && !HasFatalFailure()) {
    expect_agreement(all, 64);
  }
}

}  // namespace
}  // namespace sonard::test
