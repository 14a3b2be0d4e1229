// SPDX-License-Identifier: Apache-2.0
// Receiver::pass() leaves the receiver in the state that receive() does.
#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/receiver.hpp"
#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

constexpr int lines = 200;

/// A ping of a sonar that moves and turns a little from ping to ping.
PingRequest ping(int number, const std::function<void(SonarSettings&)>& adjust) {
  PingRequest request = bare_request(lines);
  request.ping_number = static_cast<std::uint64_t>(number);
  request.T_world_sonar.position_m.x = 0.004 * number;
  request.T_world_sonar.orientation = glm::angleAxis(0.001 * number, glm::dvec3(0, 0, 1));
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::ou;
  request.settings.physical.pulse.shape = PulseSettings::Shape::tone;
  request.settings.physical.pulse.range_cell_m = 3.0 * request.settings.range.step_m;
  request.settings.physical.noise.on = true;
  request.settings.physical.noise.level_db = -60.0;
  adjust(request.settings);
  return request;
}

/// Every third line is empty, a different third in each ping.
EchoImage echo_of(const PingRequest& request) {
  const int beams = request.settings.aperture.beam_count();
  EchoImage echo{beams, lines, std::vector<float>(static_cast<std::size_t>(beams * lines), 0.01F)};
  for (std::size_t i = 0; i < echo.intensity.size(); ++i) {
    if ((i % lines + request.ping_number) % 3 == 0) {
      echo.intensity[i] = 0.0F;
    }
  }
  return echo;
}

struct Case {
  std::string name;
  std::function<void(SonarSettings&)> adjust;
};
std::ostream& operator<<(std::ostream& out, const Case& of) {
  return out << of.name;
}

class Passed : public testing::TestWithParam<Case> {};

TEST_P(Passed, TheNextPingIsTheSame) {
  WorkerPool workers;
  Receiver whole, passing;
  for (int number = 0; number < 5; ++number) {
    const PingRequest request = ping(number, GetParam().adjust);
    const PingSamples received = whole.receive(echo_of(request), request, 2, workers);
    if (number == 1 || number == 4) {
      EXPECT_EQ(passing.receive(echo_of(request), request, 2, workers).u16, received.u16) << number;
    } else {
      ASSERT_TRUE(passing.pass(request, 2, workers));
    }
  }
}

// Otherwise the test above would pass with a pass() that does nothing.
TEST_P(Passed, WithoutThePingsBetweenOnlySpeckleThatIsKeptDiffers) {
  WorkerPool workers;
  Receiver whole, forgetful;
  const PingRequest last = ping(1, GetParam().adjust);
  whole.receive(echo_of(last), ping(0, GetParam().adjust), 2, workers);
  const bool same = whole.receive(echo_of(last), last, 2, workers).u16 ==
                    forgetful.receive(echo_of(last), last, 2, workers).u16;
  const bool kept = last.settings.model == Model::physical &&
                    last.settings.physical.speckle.kind == SpeckleSettings::Kind::ou;
  EXPECT_EQ(same, !kept);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, Passed,
    testing::Values(
        Case{"fan", [](SonarSettings&) {}},
        Case{"fan_with_texture", [](SonarSettings& s) { s.physical.speckle.texture_nu = 1.5; }},
        Case{"frozen", [](SonarSettings& s) { s.physical.speckle.kind = SpeckleSettings::Kind::frozen; }},
        Case{"per_ping", [](SonarSettings& s) { s.physical.speckle.kind = SpeckleSettings::Kind::per_ping; }},
        Case{"scanning_beam",
             [](SonarSettings& s) {
               s.aperture.beam_edges_rad = {0.03, -0.03};
             }},
        Case{"scanning_beam_without_pulse",
             [](SonarSettings& s) {
               s.aperture.beam_edges_rad = {0.03, -0.03};
               s.physical.pulse.shape = PulseSettings::Shape::point;
             }},
        Case{"paper", [](SonarSettings& s) { s.model = Model::paper; }}),
    [](const auto& of) { return of.param.name; });

TEST(Pass, SaysSoWhereOnlyTheEchoKnows) {
  WorkerPool workers;
  const auto no_pulse = [](SonarSettings& s) { s.physical.pulse.shape = PulseSettings::Shape::point; };
  Receiver whole, passing;
  const PingRequest first = ping(0, no_pulse);
  EXPECT_FALSE(passing.pass(first, 0, workers));
  EXPECT_EQ(passing.receive(echo_of(first), first, 0, workers).u16,
            whole.receive(echo_of(first), first, 0, workers).u16);
}

}  // namespace
}  // namespace sonard::render
