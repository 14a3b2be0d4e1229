// SPDX-License-Identifier: Apache-2.0
// Speckle of a scanning head belongs to the bearings of the world (docs/physics.md 2.8, 2.16).
#include "renderer/acoustics/scanned_speckle.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "tests/support/correlation.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/renderer/acoustics/receiver_bench.hpp"

namespace sonard::render {
namespace {

constexpr int scanned_lines = 4000;

PingRequest beam_request() {
  PingRequest request = bare_request(scanned_lines);
  request.settings.aperture.beam_edges_rad = {1.5 * degree, -1.5 * degree};
  request.settings.aperture.receive_beamwidth_rad = 3 * degree;
  return request;
}

Pose looking(double bearing_rad, const Pose& T_world_head = {}) {
  return T_world_head * Pose{{}, glm::angleAxis(bearing_rad, glm::dvec3(0, 0, 1))};
}

class Scan {
 public:
  explicit Scan(const PingRequest& request = beam_request()) : request_(request) {}

  std::vector<double> field_at(const Pose& T_world_sonar) {
    request_.T_world_sonar = T_world_sonar;
    ++request_.ping_number;
    return intensities_of(receiver_.receive(even_echo(request_, 0.01), request_, 0, workers_));
  }

 private:
  PingRequest request_;
  Receiver receiver_;
  WorkerPool workers_{1};
};

constexpr double scanned_bound = 0.08;  // five standard errors of 4000 lines

// exp(-(d / 3 degrees)^2) of the field, its square in the intensity, at any bearing and across +-180
// degrees.
TEST(ScannedSpeckle, BearingsAreCorrelatedByTheLawOfTheFan) {
  for (const double from_deg : {0.0, 33.3, 179.6, -90.1}) {
    Scan scan;
    const std::vector<double> first = scan.field_at(looking(from_deg * degree));
    for (const double apart_deg : {0.225, 0.45, 0.9, 1.8, 6.0}) {
      EXPECT_NEAR(test::correlation(first, scan.field_at(looking((from_deg + apart_deg) * degree))),
                  std::exp(-2 * std::pow(apart_deg / 3, 2)), scanned_bound)
          << from_deg << ' ' << apart_deg;
    }
  }
}

TEST(ScannedSpeckle, ASweepLaterEchoesAreTheSame) {
  Scan scan;
  const std::vector<double> first = scan.field_at(looking(0.3));
  for (int step = 0; step < 400; ++step) {
    scan.field_at(looking(0.3 + step * 0.9 * degree));
  }
  EXPECT_EQ(scan.field_at(looking(0.3)), first);
}

TEST(ScannedSpeckle, AmplitudesStayRayleigh) {
  Scan scan;
  double sum = 0, square = 0;
  int n = 0;
  for (double bearing = 0; bearing < 2; bearing += 0.23) {
    for (const double intensity : scan.field_at(looking(bearing))) {
      sum += intensity;
      square += intensity * intensity;
      ++n;
    }
  }
  EXPECT_NEAR(sum / n / 0.01, 1, 0.03);
  EXPECT_NEAR(square / n / 1e-4, 2, 0.15);
}

// The vehicle turns to port while the head turns to starboard: the beam keeps its bearing in the world.
TEST(ScannedSpeckle, TurnsOfTheVehicleAboutTheAxisAreTurnsOfTheHead) {
  for (const glm::dvec3& axis : {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 0), glm::dvec3(0.6, 0, -0.8)}) {
    const Pose mounted{{1, 2, 3}, glm::angleAxis(0.7, axis)};
    Scan scan;
    const std::vector<double> first = scan.field_at(looking(0.4, mounted));
    const std::vector<double> again = scan.field_at(looking(0.4 - 0.2, looking(0.2, mounted)));
    EXPECT_NEAR(test::correlation(first, again), 1, 1e-6);
  }
}

TEST(ScannedSpeckle, MotionOfTheVehicleFades) {
  for (const auto& [dx_m, tilt_rad, expected] :
       {std::tuple{0.02, 0.0, std::exp(-2 * 0.16)}, std::tuple{0.0, 0.75 * degree, std::exp(-2 * 0.25)}}) {
    Scan scan;
    const std::vector<double> first = scan.field_at(looking(0.4));
    const Pose moved{{dx_m, 0, 0}, glm::angleAxis(tilt_rad, glm::dvec3(std::sin(-0.4), std::cos(0.4), 0))};
    EXPECT_NEAR(test::correlation(first, scan.field_at(looking(0.4, moved))), expected, scanned_bound);
  }
}

TEST(ScannedSpeckle, FrozenSpeckleDoesNotFade) {
  PingRequest request = beam_request();
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::frozen;
  Scan scan(request);
  const std::vector<double> first = scan.field_at(looking(0.4));
  EXPECT_EQ(scan.field_at(looking(0.4, {{5, 0, 0}, {1, 0, 0, 0}})), first);
}

// sinc(x / cell) in its main lobe, as in PulseCorrelation.
TEST(ScannedSpeckle, IsCorrelatedByThePulse) {
  PingRequest request = beam_request();
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = 2 * request.settings.range.step_m;
  Scan scan(request);
  const std::vector<double> field = scan.field_at(looking(0.4));
  const double side = 2 / std::numbers::pi;
  const double expected = 2 * side / (1 + 2 * side * side);
  EXPECT_NEAR(test::correlation({field.begin(), field.end() - 1}, {field.begin() + 1, field.end()}),
              expected * expected, scanned_bound);
}

TEST(ScannedSpeckle, TextureComesBackToo) {
  PingRequest request = beam_request();
  request.settings.physical.speckle.texture_nu = 1;
  Scan scan(request);
  const std::vector<double> first = scan.field_at(looking(0.4));
  EXPECT_LT(test::correlation(first, scan.field_at(looking(1.4))), 0.3);
  EXPECT_EQ(scan.field_at(looking(0.4)), first);
}

}  // namespace
}  // namespace sonard::render
