// SPDX-License-Identifier: Apache-2.0
// A small world and a small fan for the tests of the ledger.
#pragma once

#include "tests/support/engine_test.hpp"

namespace sonard::test {

inline render::PingRequest small_request() {
  render::PingRequest request;
  request.T_world_sonar = {{0, 0, 3}, glm::angleAxis(0.35, glm::dvec3(0, 1, 0))};
  request.settings.aperture.beam_edges_rad = render::equal_angle_edges(64, 2.0943951023931953);
  request.settings.range = {400, 0.04, 0, false};
  request.ping_number = 1;
  request.seed = 11;
  return request;
}

/// A bed 2 m to 20 m ahead, and a ball on it.
inline render::World bed_and_ball() {
  render::Body ball = make_body("ball", make_sphere(0.5F, 16));
  ball.T_world_body.position_m = {8, 1, 0.5};
  return make_world({make_body("bed", make_quad({2, -20, 0}, {18, 0, 0}, {0, 40, 0}), 0.3), ball});
}

}  // namespace sonard::test
