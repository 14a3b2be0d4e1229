// SPDX-License-Identifier: Apache-2.0
// The world for tests that change engines.
#pragma once

#include "tests/support/engine_test.hpp"

namespace sonard::test {

/// Perpendicular to x, 8 m ahead, 20 m wide and 10 m high.
inline render::Body wall_ahead() {
  return make_body("wall", make_quad({8, 10, -5}, {0, -20, 0}, {0, 0, 10}));
}

/// The ball's centre is the origin until a test moves it.
inline render::World wall_and_ball() {
  return make_world({wall_ahead(), make_body("ball", make_sphere(0.5F, 24))});
}

}  // namespace sonard::test
