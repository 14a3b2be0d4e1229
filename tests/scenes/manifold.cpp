// SPDX-License-Identifier: Apache-2.0
#include "tests/scenes/manifold.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>

#include "tests/scenes/shapes.hpp"

namespace sonard::test {

namespace {

struct Pipe {
  glm::dvec3 from_m, to_m;
  double radius_m;
  double area_m2() const {
    return 2 * std::numbers::pi * radius_m * (glm::distance(from_m, to_m) + radius_m);
  }
};

struct Valve {
  glm::dvec3 centre_m;
  double radius_m;
  double area_m2() const { return 4 * std::numbers::pi * radius_m * radius_m; }
};

/// Posts, beams and braces of the protective frame.
void add_frame(std::vector<Pipe>& pipes) {
  constexpr double member = 0.09;
  for (const double x : {-3.0, -1.0, 1.0, 3.0}) {
    pipes.push_back({{x, -2, 0}, {x, -2, 2.4}, member});
    pipes.push_back({{x, 2, 0}, {x, 2, 2.4}, member});
    pipes.push_back({{x, -2, 2.4}, {x, 2, 2.4}, member});
    pipes.push_back({{x, -2, 0.1}, {x, 2, 0.1}, member});
  }
  for (const double y : {-2.0, 2.0}) {
    pipes.push_back({{-3, y, 2.4}, {3, y, 2.4}, member});
    pipes.push_back({{-3, y, 0.1}, {3, y, 0.1}, member});
    pipes.push_back({{-3, y, 0.1}, {-1, y, 2.4}, 0.06});
    pipes.push_back({{3, y, 0.1}, {1, y, 2.4}, 0.06});
  }
}

/// Two headers, and branches that rise from them, each with a valve.
void add_piping(std::vector<Pipe>& pipes, std::vector<Valve>& valves) {
  for (const double y : {-0.7, 0.7}) {
    pipes.push_back({{-3.0, y, 0.6}, {3.0, y, 0.6}, 0.20});
    for (const double x : {-2.2, -0.7, 0.8, 2.3}) {
      pipes.push_back({{x, y, 0.6}, {x, y, 1.7}, 0.11});
      pipes.push_back({{x, y, 1.5}, {x, 2.4 * y, 1.5}, 0.08});
      valves.push_back({{x, y, 1.15}, 0.24});
      valves.push_back({{x, 1.9 * y, 1.5}, 0.16});
    }
  }
}

int at_least(int least, double value) {
  return std::max(least, static_cast<int>(std::lround(value)));
}

/// A tube of about `facets` triangles, as 2 around (along + 1), which are nearly squares cut in two.
render::TriangleMesh make_facetted(const Pipe& pipe, double facets) {
  const double length_m = glm::distance(pipe.from_m, pipe.to_m);
  const double circumference_m = 2 * std::numbers::pi * pipe.radius_m;
  const int around = at_least(6, std::sqrt(facets / 2 * circumference_m / length_m));
  return make_tube(pipe.from_m, pipe.to_m, pipe.radius_m, around, at_least(1, facets / (2 * around) - 1));
}

render::TriangleMesh make_facetted(const Valve& valve, double facets) {
  const int around = at_least(6, std::sqrt(facets));
  return make_ball(valve.centre_m, valve.radius_m, around, at_least(3, facets / (2 * around) + 1));
}

}  // namespace

render::TriangleMesh make_manifold(std::size_t triangles) {
  std::vector<Pipe> pipes;
  std::vector<Valve> valves;
  add_frame(pipes);
  add_piping(pipes, valves);
  double area_m2 = 0;
  for (const Pipe& pipe : pipes) {
    area_m2 += pipe.area_m2();
  }
  for (const Valve& valve : valves) {
    area_m2 += valve.area_m2();
  }
  const double facets_per_m2 = static_cast<double>(triangles) / area_m2;
  render::TriangleMesh mesh;
  for (const Pipe& pipe : pipes) {
    append(mesh, make_facetted(pipe, facets_per_m2 * pipe.area_m2()));
  }
  for (const Valve& valve : valves) {
    append(mesh, make_facetted(valve, facets_per_m2 * valve.area_m2()));
  }
  return mesh;
}

}  // namespace sonard::test
