// SPDX-License-Identifier: Apache-2.0
// Both integrators compared with closed forms (docs/physics.md 3.2), which make them references.
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "tests/oracle/bvh.hpp"
#include "tests/oracle/ray_integrator.hpp"
#include "tests/oracle/shapes.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/support/closed_forms.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/tests/oracle/small_worlds.hpp"

namespace sonard::oracle {

namespace {

constexpr Material white{1.0, 1.0};
constexpr int nodes = 1500;  // of the closed forms in azimuth

/// The 256 beams of a Gemini; both edges, the middle, and some between.
const std::vector<int> chosen = {0, 41, 127, 128, 200, 255};

EchoTruth slices_of(const render::World& world, const EchoLaw& law, const std::vector<int>& beams) {
  SliceOptions options;
  options.error_rms = 2e-5;
  options.error_max = 4e-4;
  options.beams = beams;
  return integrate_slices(Facets(world, {}, law), law, options);
}

RayOptions ray_options(const std::vector<int>& beams, int doublings) {
  RayOptions options;
  options.error_rms = 1e-4;
  options.error_max = 4e-3;
  options.doublings = doublings;
  options.beams = beams;
  return options;
}

EchoTruth rays_of(const Surface& surface, const EchoLaw& law, const std::vector<int>& beams,
                  int doublings = 4) {
  return integrate_rays(surface, law, ray_options(beams, doublings));
}

/// Within 1e-4, and within the integrator's own error; `slack` is the error of the closed form.
void expect_reference(const EchoTruth& measured, const EchoTruth& truth) {
  const RelativeError error = difference(measured, truth);
  const RelativeError claim = estimated_error(measured);
  EXPECT_LT(error.rms, 1e-4);
  EXPECT_LT(error.max, 2e-3);
  constexpr double slack = 5e-5;
  EXPECT_LT(error.rms, claim.rms + slack);
  EXPECT_NEAR(total(measured) / total(truth), 1.0, 2e-5);
}

struct PlaneCase {
  const char* name;
  glm::dvec3 foot;  // nearest point of the plane
  double range_m;
  int lines;
};

class PlaneClosedForm : public testing::TestWithParam<PlaneCase> {
 protected:
  PlaneCase plane_ = GetParam();
  render::SonarSettings settings_ = ping(256, 120 * degree, 20 * degree, plane_.lines, plane_.range_m);
  EchoLaw law_{settings_};

  EchoTruth truth() const {
    const glm::dvec3 n = glm::normalize(plane_.foot);
    const test::PlaneTruth plane{glm::length(plane_.foot), n.x, n.y, n.z, 10 * degree};
    const std::vector<double>& edges = law_.beam_edges_rad();
    return closed_form(settings_, chosen, [&](int beam, double r1, double r2) {
      const auto b = static_cast<std::size_t>(beam);
      return plane.beam(edges[b + 1], edges[b], r1, r2, nodes);
    });
  }
};

TEST_P(PlaneClosedForm, BySlicesOfTwoTriangles) {
  expect_reference(slices_of(plane_world(plane_.foot), law_, chosen), truth());
}

TEST_P(PlaneClosedForm, ByRaysOnTheFormula) {
  const auto plane = make_plane(plane_.foot, glm::normalize(plane_.foot), white);
  expect_reference(rays_of(*plane, law_, chosen), truth());
}

TEST_P(PlaneClosedForm, ByRaysOnTwoTriangles) {
  const Facets facets(plane_world(plane_.foot), {}, law_);
  expect_reference(rays_of(Bvh(facets), law_, chosen), truth());
}

INSTANTIATE_TEST_SUITE_P(Oracle, PlaneClosedForm,
                         testing::Values(PlaneCase{"T1_slope", {3.1, 1.3, -4.2}, 20.0, 300},
                                         PlaneCase{"T2_wall", {10, 0, 0}, 20.5, 500},
                                         PlaneCase{"T3_seabed", {0, 0, -5}, 50.0, 250},
                                         PlaneCase{"T3_seabed_tilted",
                                                   {4 * std::sin(20 * degree), 0, -4 * std::cos(20 * degree)},
                                                   20.0,
                                                   250}),
                         [](const auto& plane) { return plane.param.name; });

TEST(OracleClosedForm, ExamplesOfTheDocument) {
  // T2: d = 10 m, dead ahead, 10 degrees: E per radian 3.42083991e-3; T3: h = 5 m, R = 120 m: 9.06231e-6.
  render::SonarSettings settings = ping(1, 1e-4 * degree, 20 * degree, 120, 120);
  const EchoLaw law(settings);
  const double width = 1e-4 * degree;
  EXPECT_NEAR(total(slices_of(plane_world({10, 0, 0}), law, {0})) / width, 3.42083991e-3, 1e-10);
  EXPECT_NEAR(total(slices_of(plane_world({0, 0, -5}), law, {0})) / width, 9.06231e-6, 1e-11);
}

TEST(OracleClosedForm, T4SphereSummedOverBeams) {
  const render::SonarSettings settings = ping(16, 10 * degree, 20 * degree, 100, 10);
  const EchoLaw law(settings);
  const EchoTruth rays = rays_of(*make_sphere({8, 0, 0}, 0.5, white), law, {}, 3);
  std::vector<double> truth, measured;
  for (int k = 0; k < settings.range.count; ++k) {
    truth.push_back(test::sphere_echo(0.5, 8, k * settings.range.step_m, (k + 1) * settings.range.step_m));
    measured.push_back(0);
    for (int beam = 0; beam < rays.beams; ++beam) {
      measured.back() += rays.at(beam, k);
    }
  }
  EXPECT_LT(test::rms_error(truth, measured, 1e-2), 1e-4);
  EXPECT_NEAR(total(rays) / 1.411161e-4, 1.0, 1e-4);
}

TEST(OracleClosedForm, T5UprightCylinder) {
  const render::SonarSettings settings = ping(24, 12 * degree, 20 * degree, 200, 12);
  const EchoLaw law(settings);
  const auto cylinder = make_cylinder({{8, 0, 0}, {1, 0, 0, 0}}, 0.6, 20, white);
  const std::vector<int> beams = {3, 4, 11, 17};
  const std::vector<double>& edges = law.beam_edges_rad();
  const EchoTruth truth = closed_form(settings, beams, [&](int beam, double r1, double r2) {
    const auto b = static_cast<std::size_t>(beam);
    return test::azimuth_integral(
        [&](double psi) { return test::cylinder_density(0.6, 8, 10 * degree, psi, r1, r2); }, edges[b + 1],
        edges[b], 4 * nodes);
  });
  RayOptions options = ray_options(beams, 3);
  options.rows = 64;
  options.refinements = 6;  // first order at the limb: the last cells must be small
  expect_reference(integrate_rays(*cylinder, law, options), truth);
}

TEST(OracleClosedForm, T6TwoWallsThatMeetInsideABeam) {
  const render::SonarSettings settings = ping(32, 20 * degree, 20 * degree, 400, 16);
  const EchoLaw law(settings);
  const std::vector<double>& edges = law.beam_edges_rad();
  const double corner = edges[16] + 0.3 * (edges[15] - edges[16]);  // inside beam 15
  // Left of it (larger psi) a wall at 10 m, right of it one at 13 m: the near one ends at the corner.
  const double edge_y = 10 * std::tan(corner);
  const std::vector<render::TriangleMesh> walls = {quad({10, edge_y + 50, 0}, {0, 50, 0}, {0, 0, 50}),
                                                   quad({13, 0, 0}, {0, 100, 0}, {0, 0, 50})};
  const test::PlaneTruth near{10, 1, 0, 0, 10 * degree};
  const test::PlaneTruth far{13, 1, 0, 0, 10 * degree};
  const std::vector<int> beams = {14, 15, 16};
  const EchoTruth truth = closed_form(settings, beams, [&](int beam, double r1, double r2) {
    const auto b = static_cast<std::size_t>(beam);
    const double split = std::clamp(corner, edges[b + 1], edges[b]);
    return near.beam(split, edges[b], r1, r2, nodes) + far.beam(edges[b + 1], split, r1, r2, nodes);
  });
  const EchoTruth slices = slices_of(world_of(walls), law, beams);
  expect_reference(slices, truth);
  for (int k = 0; k < settings.range.count; ++k) {
    const double r1 = k * settings.range.step_m;
    if (r1 > 10.2 && r1 + settings.range.step_m < 13) {
      EXPECT_EQ(slices.at(15, k), 0.0) << "line " << k;
    }
  }
  std::vector<std::unique_ptr<Surface>> shapes;
  shapes.push_back(make_thin_wall({10, edge_y + 50, 0}, {0, 50, 0}, {0, 0, 50}, white));
  shapes.push_back(make_plane({13, 0, 0}, {1, 0, 0}, white));
  const EchoTruth rays = rays_of(*make_group(std::move(shapes)), law, beams, 3);
  // The corner is not at a cell's edge: its beam converges with first order, by half of the finest cell.
  const RelativeError error = difference(rays, truth);
  EXPECT_LT(error.rms, 1.0 / (4 * 8 * 8));
  EXPECT_LT(error.rms, estimated_error(rays).rms + 1e-4);
}

TEST(OracleClosedForm, T7WallAndItsShadow) {
  const render::SonarSettings settings = ping(32, 20 * degree, 60 * degree, 400, 24);
  const EchoLaw law(settings);
  const std::vector<int> beams = {0, 9, 16};
  const test::ShadowTruth shadow{5, 1.5, 12, 30 * degree};
  const std::vector<double>& edges = law.beam_edges_rad();
  const EchoTruth truth = closed_form(settings, beams, [&](int beam, double r1, double r2) {
    const auto b = static_cast<std::size_t>(beam);
    return test::azimuth_integral([&](double psi) { return shadow.density(psi, r1, r2); }, edges[b + 1],
                                  edges[b], nodes);
  });
  const glm::dvec3 centre(12, 0, -5 + 0.75);
  const std::vector<render::TriangleMesh> meshes = {quad({0, 0, -5}, {500, 0, 0}, {0, 500, 0}),
                                                    quad(centre, {0, 40, 0}, {0, 0, 0.75})};
  const EchoTruth slices = slices_of(world_of(meshes), law, beams);
  expect_reference(slices, truth);
  // In beam 16, beside the axis: no echo between the foot of the wall (13.0 m) and the end of the shadow.
  for (int k = 0; k < settings.range.count; ++k) {
    const double r1 = k * settings.range.step_m;
    if (r1 > 13.01 && r1 + settings.range.step_m < 17.857) {
      EXPECT_EQ(slices.at(16, k), 0.0) << "line " << k;
    }
  }
  std::vector<std::unique_ptr<Surface>> shapes;
  shapes.push_back(make_plane({0, 0, -5}, {0, 0, 1}, white));
  shapes.push_back(make_thin_wall(centre, {0, 40, 0}, {0, 0, 0.75}, white));
  const EchoTruth rays = rays_of(*make_group(std::move(shapes)), law, beams, 3);
  EXPECT_LT(difference(rays, truth).rms, 1e-3);  // first order at the upper edge of the wall
  EXPECT_LT(difference(rays, truth).rms, estimated_error(rays).rms + 1e-4);
}

TEST(OracleClosedForm, T14AbsorptionBetweenAWallAndOneTwiceAsFar) {
  render::SonarSettings settings = ping(1, 0.2 * degree, 2 * degree, 250, 25);
  settings.physical.absorption_db_per_m = 0.25;
  const EchoLaw law(settings);
  // The range grows by 1.5e-4 of itself to the corners of so narrow a beam, and the absorption with it.
  const double near = total(slices_of(plane_world({10, 0, 0}), law, {0}));
  const double far = total(slices_of(plane_world({20, 0, 0}), law, {0}));
  EXPECT_NEAR(10 * std::log10(near / far), 20 * std::log10(2.0) + 2 * 0.25 * 10, 1e-3);
  const double ray_near = total(rays_of(*make_plane({10, 0, 0}, {1, 0, 0}, white), law, {0}, 1));
  EXPECT_NEAR(ray_near / near, 1.0, 1e-5);
}

TEST(OracleClosedForm, PaperModeIsTheSigmoidOfTheIncidence) {
  // E_pap(r) = S(rho D / r) on any plane, to second order in the step (T1).
  render::SonarSettings settings = ping(256, 120 * degree, 20 * degree, 1200, 12);
  settings.model = render::Model::paper;
  const EchoLaw law(settings);
  const glm::dvec3 foot(2.5, 0.5, -3.0);
  const EchoTruth slices = slices_of(plane_world(foot), law, chosen);
  const EchoTruth rays = rays_of(*make_plane(foot, glm::normalize(foot), white), law, chosen, 2);
  constexpr int ends = 8;  // lines at the ends of the fan, which the plane fills only partly
  int compared = 0;
  for (const int beam : chosen) {
    for (int k = ends; k + ends < settings.range.count; ++k) {
      if (slices.at(beam, k - ends) > 0 && slices.at(beam, k + ends) > 0) {
        const double r = (k + 0.5) * settings.range.step_m;
        const double expected = 1 / (1 + std::exp(-18 * (glm::length(foot) / r - 2.0 / 3)));
        EXPECT_NEAR(slices.at(beam, k), expected, 3e-4 * expected) << beam << ' ' << k;
        EXPECT_NEAR(rays.at(beam, k), expected, 1e-3 * expected) << beam << ' ' << k;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(OracleClosedForm, SincPatternWeighsTheElevations) {
  // A wall in a sliver of azimuth: E per radian = integral of b(theta) cos^4(theta) / d^2 over the fan.
  render::SonarSettings settings = ping(1, 1e-3 * degree, 20 * degree, 60, 12);
  settings.aperture.elevation = render::Aperture::Elevation::sinc;
  const EchoLaw law(settings);
  const auto pattern = [](double theta) {
    const double x = std::numbers::pi * 0.443 * std::sin(theta) / std::sin(10 * degree);
    return x == 0 ? 1.0 : std::pow(std::sin(x) / x, 2);
  };
  EXPECT_NEAR(10 * std::log10(pattern(10 * degree)), -3, 0.02);
  const double limit = 25 * degree;  // rendered to 1.25 beamwidths on either side
  const double expected = test::azimuth_integral(
      [&](double theta) { return pattern(theta) * std::pow(std::cos(theta), 4) / 100; }, -limit, limit, 4000);
  EXPECT_NEAR(total(slices_of(plane_world({10, 0, 0}), law, {0})) / (1e-3 * degree) / expected, 1.0, 1e-6);
  EXPECT_NEAR(
      total(rays_of(*make_plane({10, 0, 0}, {1, 0, 0}, white), law, {0}, 1)) / (1e-3 * degree) / expected,
      1.0, 1e-5);
}

}  // namespace

}  // namespace sonard::oracle
