// SPDX-License-Identifier: Apache-2.0
// Facets (docs/physics.md 2.4): their echo lies within a few degrees of normal incidence.
#include <cmath>
#include <numbers>
#include <random>

#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/kink_quadrature.hpp"

namespace sonard::test {
namespace {

class FacetAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, FacetAccuracy, all_cases(), case_name);

/// R and m of clean steel and of concrete, and a tenth of their mu.
constexpr FacetLaw clean_steel{0.94, 0.05, 3.2e-4};
constexpr FacetLaw concrete{0.68, 0.2, 1.6e-3};

render::Body with_law(render::Body body, const FacetLaw& law) {
  render::AcousticMaterial& material = body.parts.front().material;
  material.lambert_mu = law.lambert_mu;
  material.pressure_reflection = -law.reflection;  // only its square counts
  material.rms_slope = law.slope;
  return body;
}

/// `beams` beams of 120/256 degrees, in lines of 8 mm.
Scene scene_of(render::Body body, int lines, int beams) {
  Scene scene = forward_looking_scene({std::move(body)}, {lines, 0.008, 0, false});
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, beams * 120.0 / 256 * degree);
  return scene;
}

double total(const render::EchoImage& image) {
  double sum = 0;
  for (const float echo : image.intensity) {
    sum += static_cast<double>(echo);
  }
  return sum;
}

/// On a plane cos phi = D / r.
render::EchoImage wall_truth(const Scene& scene, const FacetLaw& law, const glm::dvec3& n,
                             double distance_m) {
  const PlaneTruth plane{distance_m, n.x, n.y, n.z, scene.settings.aperture.elevation_limit_rad()};
  // Angle from `foot` at which the foot point of a half plane, at range D / A, has range r.
  const double horizontal = std::hypot(n.x, n.y), foot = std::atan2(n.y, n.x);
  const auto kink = [&](double r) {
    return std::acos(std::sqrt(distance_m * distance_m / (r * r) - n.z * n.z) / horizontal);
  };
  return image_of_beams(scene.settings, [&](double from, double to, double r1, double r2) {
    const auto echo = [&](double a, double b) {
      return kinked_integral([&](double psi) { return plane.density(psi, a, b); }, from, to,
                             {foot - kink(a), foot + kink(a), foot - kink(b), foot + kink(b)});
    };
    return weighted_echo(
        echo, [&](double r) { return law.relative(distance_m / r); }, distance_m, r1, r2, 24);
  });
}

// If its normal is off by 1e-4 rad, a wall of steel is off by 1 % and more far from its foot point.
TEST_P(FacetAccuracy, FacetWalls) {
  struct Foot {
    double port_deg, below_deg;
  };
  for (const FacetLaw& law : {clean_steel, concrete}) {
    for (const Foot foot : {Foot{4, 2}, {-9, -3}, {-5.1, -1.71}, {-2.5, -0.85}, {7.9, 2.59}, {10.5, 3.45}}) {
      const glm::dvec3 n(std::cos(foot.port_deg * degree) * std::cos(foot.below_deg * degree),
                         std::sin(foot.port_deg * degree) * std::cos(foot.below_deg * degree),
                         -std::sin(foot.below_deg * degree));
      const glm::dvec3 a = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1)));
      const glm::dvec3 b = glm::cross(n, a);
      const Scene scene = scene_of(
          with_law(make_body("wall", make_quad(8.0 * n - 20.0 * a - 20.0 * b, 40.0 * a, 40.0 * b)), law),
          1140, 48);
      expect_within(targets(), measure(render(scene), wall_truth(scene, law, n, 8.0)),
                    "wall, m = " + std::to_string(law.slope));
    }
  }
}

TEST_P(FacetAccuracy, Spheres) {
  for (const FacetLaw& law : {clean_steel, concrete}) {
    constexpr double half_facet = std::numbers::pi / 256;
    render::Body sphere = with_law(
        make_body("sphere", make_sphere(static_cast<float>(0.5 * half_facet / std::sin(half_facet)), 256)),
        law);
    sphere.T_world_body.position_m = {8 * std::cos(1 * degree), 8 * std::sin(1 * degree), 0.1};
    const Scene scene = scene_of(sphere, 1010, 20);
    const SphereTruth truth{0.5, 8, 1 * degree, 0.1};
    const double centre_m = std::hypot(8, 0.1);
    const double limb2 = centre_m * centre_m - 0.25;
    const render::EchoImage expected =
        image_of_beams(scene.settings, [&](double from, double to, double r1, double r2) {
          const int steps = r1 < centre_m - 0.48 ? 96 : 12;  // all facets of steel echo within 2 mm
          return weighted_echo([&](double a, double b) { return truth.beam(from, to, a, b); },
                               [&](double r) { return law.relative((limb2 - r * r) / r); }, centre_m - 0.5,
                               r1, r2, steps);
        });
    expect_within(targets(), measure(render(scene), expected), "sphere, m = " + std::to_string(law.slope));
  }
}

// The echo of a convex mirror of radius a at distance d, its centre at R0 = d + a, is |R|^2 a^2 / (4 d^2
// R0^2). Far away this is the target strength of a rigid sphere, a^2 / 4. Facets agree within 1 % for m <=
// 0.1 (docs/physics.md 2.4).
TEST_P(FacetAccuracy, SphereEchoesLikeAMirror) {
  for (const double m : {0.02, 0.1}) {
    const FacetLaw law{0.9, m, 0.0};
    render::Body sphere = with_law(make_body("sphere", make_sphere(0.3F, 128)), law);
    sphere.T_world_body.position_m = {6, 0.1, -0.2};
    const Scene scene = scene_of(sphere, 800, 16);
    const double centre_m = std::sqrt(36 + 0.01 + 0.04), d = centre_m - 0.3;
    const double expected = std::pow(0.9 * 0.3 / (2 * d * centre_m), 2);
    const double found = total(render(scene));
    std::printf("sphere, m = %.2f: %.4f of a mirror's echo\n", m, found / expected);
    EXPECT_NEAR(found / expected, 1.0, 0.01) << m;
  }
}

// The slopes of a normal map add to the slopes of facets. Both are Gaussian, so their sum is Gaussian with
// the sum of the variances; its echo is the truth. The texels are far smaller than the footprint of a sample.
TEST_P(FacetAccuracy, FineNormalMapsWidenFacets) {
  constexpr double map_slope = 0.1, distance_m = 8;
  const FacetLaw widened{0.94, std::hypot(0.05, map_slope), 3.2e-4};
  render::NormalMap map{128, 128, {}};
  std::mt19937 random(7);
  std::normal_distribution<float> slope(0.0F, static_cast<float>(map_slope));
  for (int i = 0; i < 128 * 128; ++i) {
    const glm::vec3 n = glm::normalize(glm::vec3(slope(random), slope(random), 1.0F));
    for (int k = 0; k < 3; ++k) {
      map.rgb.push_back(static_cast<std::uint8_t>(std::lround((n[k] + 1) * 127.5F)));
    }
  }
  render::TriangleMesh mesh = make_quad({8, -20, -20}, {0, 40, 0}, {0, 0, 40});
  mesh.normals.assign(4, {-1, 0, 0});
  mesh.tangents.assign(4, {0, 1, 0, 1});
  mesh.texcoords = {{0, 0}, {100, 0}, {100, 100}, {0, 100}};  // texels of 3 mm
  render::Body wall = with_law(make_body("wall", std::move(mesh)), clean_steel);
  wall.parts.front().normal_map = std::make_shared<const render::NormalMap>(std::move(map));
  const Scene scene = scene_of(wall, 1140, 48);
  const double found = total(render(scene));
  const double expected = total(wall_truth(scene, widened, {1, 0, 0}, distance_m));
  const double unwidened = total(wall_truth(scene, clean_steel, {1, 0, 0}, distance_m));
  std::printf("mapped wall: %.4f of the truth, %.4f of that of a smooth one\n", found / expected,
              found / unwidened);
  EXPECT_NEAR(found / expected, 1.0, 0.03);
  EXPECT_GT(std::abs(found / unwidened - 1), 0.15) << "else nothing is shown";
}

}  // namespace
}  // namespace sonard::test
