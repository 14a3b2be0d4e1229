// Facets (docs/physics.md 2.4): their echo lies within a few degrees of normal incidence.
#include <cmath>
#include <numbers>

#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"
#include "tests/support/kink_quadrature.hpp"

namespace sonard::test {
namespace {

constexpr double degree = std::numbers::pi / 180;

class FacetAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, FacetAccuracy, all_cases(), case_name);

/// R and m of clean steel and of concrete, and a tenth of their mu.
constexpr FacetLaw clean_steel{0.94, 0.05, 3.2e-4};
constexpr FacetLaw concrete{0.68, 0.2, 1.6e-3};

render::Body with_law(render::Body body, const FacetLaw& law) {
  render::AcousticMaterial& material = body.parts.front().material;
  material.lambert_mu = law.lambert_mu;
  material.pressure_reflection = -law.reflection;  // only its square is heard
  material.rms_slope = law.slope;
  return body;
}

/// 48 beams of 256 over 120 degrees, in lines of 8 mm.
Scene scene_of(render::Body body, int lines) {
  Scene scene = forward_looking_scene({std::move(body)}, {lines, 0.008, 0, false});
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(48, 48 * 120.0 / 256 * degree);
  return scene;
}

render::EchoImage wall_truth(const Scene& scene, const FacetLaw& law, const glm::dvec3& n,
                             double distance_m) {
  const PlaneTruth plane{distance_m, n.x, n.y, n.z, scene.settings.aperture.elevation_limit_rad()};
  // Where the range of the foot point of a half plane, D / A, is that of an edge.
  const double horizontal = std::hypot(n.x, n.y), foot = std::atan2(n.y, n.x);
  const auto kink = [&](double r) {
    return std::acos(std::sqrt(distance_m * distance_m / (r * r) - n.z * n.z) / horizontal);
  };
  return image_of_beams(scene.settings, [&](double from, double to, double r1, double r2) {
    return facet_echo(
        law,
        [&](double a, double b) {
          return kinked_integral([&](double psi) { return plane.density(psi, a, b); }, from, to,
                                 {foot - kink(a), foot + kink(a), foot - kink(b), foot + kink(b)});
        },
        [&](double r) { return distance_m / r; }, distance_m, r1, r2, 24);
  });
}

TEST_P(FacetAccuracy, Walls) {
  for (const FacetLaw& law : {clean_steel, concrete}) {
    // Its foot point is 4 degrees to port and 2 below the axis.
    const glm::dvec3 n(std::cos(4 * degree) * std::cos(2 * degree),
                       std::sin(4 * degree) * std::cos(2 * degree), -std::sin(2 * degree));
    const glm::dvec3 a = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1)));
    const glm::dvec3 b = glm::cross(n, a);
    const Scene scene = scene_of(
        with_law(make_body("wall", make_quad(8.0 * n - 20.0 * a - 20.0 * b, 40.0 * a, 40.0 * b)), law), 1140);
    expect_within(limits(), measure(render(scene), wall_truth(scene, law, n, 8.0)),
                  "wall, m = " + std::to_string(law.slope));
  }
}

TEST_P(FacetAccuracy, Spheres) {
  for (const FacetLaw& law : {clean_steel, concrete}) {
    render::Body sphere =
        with_law(make_body("sphere", make_sphere(static_cast<float>(0.5 * (std::numbers::pi / 512) /
                                                                    std::sin(std::numbers::pi / 512)),
                                                 512)),
                 law);
    sphere.T_world_body.position_m = {8 * std::cos(5 * degree), 8 * std::sin(5 * degree), 0.1};
    const Scene scene = scene_of(sphere, 1010);
    const SphereTruth truth{0.5, 8, 5 * degree, 0.1};
    const double limb2 = 64 + 0.01 - 0.25;
    const render::EchoImage expected = image_of_beams(scene.settings, [&](double from, double to, double r1,
                                                                          double r2) {
      return facet_echo(
          law, [&](double a, double b) { return truth.beam(from, to, a, b); },
          [&](double r) { return (limb2 - r * r) / (2 * r * 0.5); }, std::hypot(8, 0.1) - 0.5, r1, r2, 48);
    });
    expect_within(limits(), measure(render(scene), expected), "sphere, m = " + std::to_string(law.slope));
  }
}

}  // namespace
}  // namespace sonard::test
