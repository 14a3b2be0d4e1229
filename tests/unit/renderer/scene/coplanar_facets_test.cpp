// SPDX-License-Identifier: Apache-2.0
// Finely divided surfaces against their closed forms.
#include "renderer/scene/coplanar_facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using Place = std::array<float, 3>;
using Facet = std::array<glm::dvec3, 3>;

Place place_of(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

std::vector<Facet> facets_of(const TriangleMesh& mesh) {
  std::vector<Facet> facets;
  const auto at = [&](std::size_t i) { return glm::dvec3(mesh.positions.at(mesh.indices.at(i))); };
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    facets.push_back({at(i), at(i + 1), at(i + 2)});
  }
  return facets;
}

glm::dvec3 area_vector(const Facet& facet) {
  return 0.5 * glm::cross(facet[1] - facet[0], facet[2] - facet[0]);
}

glm::dvec3 normal_of(const Facet& facet) {
  return glm::normalize(area_vector(facet));
}

glm::dvec3 centre_of(const Facet& facet) {
  return (facet[0] + facet[1] + facet[2]) / 3.0;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Facet& facet : facets_of(mesh)) {
    area += glm::length(area_vector(facet));
  }
  return area;
}

/// Positive if facets are counter-clockwise seen from outside.
double volume_of(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const Facet& facet : facets_of(mesh)) {
    volume += glm::dot(facet[0], glm::cross(facet[1], facet[2])) / 6;
  }
  return volume;
}

/// The places that facets use.
std::set<Place> corners_of(const TriangleMesh& mesh) {
  std::set<Place> corners;
  for (const std::uint32_t index : mesh.indices) {
    corners.insert(place_of(mesh.positions.at(index)));
  }
  return corners;
}

/// Directed sides of facets, from corner to corner, and their counts.
std::map<std::pair<Place, Place>, int> sides_of(const TriangleMesh& mesh) {
  std::map<std::pair<Place, Place>, int> sides;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    ++sides[{place_of(mesh.positions.at(mesh.indices.at(i))),
             place_of(mesh.positions.at(mesh.indices.at(next)))}];
  }
  return sides;
}

bool is_closed(const TriangleMesh& mesh) {
  const auto sides = sides_of(mesh);
  return std::all_of(sides.begin(), sides.end(), [&](const auto& side) {
    const auto back = sides.find({side.first.second, side.first.first});
    return side.second == 1 && back != sides.end() && back->second == 1;
  });
}

/// Sides that only one facet has, from corner to corner.
std::vector<std::pair<glm::dvec3, glm::dvec3>> border_of(const TriangleMesh& mesh) {
  const auto sides = sides_of(mesh);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> border;
  for (const auto& [side, count] : sides) {
    const auto& [from, to] = side;
    if (!sides.contains({to, from})) {
      border.insert(border.end(), static_cast<std::size_t>(count),
                    {{from[0], from[1], from[2]}, {to[0], to[1], to[2]}});
    }
  }
  return border;
}

double border_length(const TriangleMesh& mesh) {
  double length = 0.0;
  for (const auto& [from, to] : border_of(mesh)) {
    length += glm::length(to - from);
  }
  return length;
}

/// Facets as places, independent of their order and of their first corner.
std::multiset<std::array<Place, 3>> places_of_facets(const TriangleMesh& mesh) {
  std::multiset<std::array<Place, 3>> facets;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    std::array<Place, 3> facet;
    for (std::size_t k = 0; k < 3; ++k) {
      facet[k] = place_of(mesh.positions.at(mesh.indices.at(i + k)));
    }
    std::rotate(facet.begin(), std::min_element(facet.begin(), facet.end()), facet.end());
    facets.insert(facet);
  }
  return facets;
}

/// A grid of cells of two facets each, with corners places[i][j].
TriangleMesh grid_of(const std::vector<std::vector<glm::vec3>>& places) {
  TriangleMesh mesh;
  const auto columns = static_cast<std::uint32_t>(places.front().size());
  for (const std::vector<glm::vec3>& row : places) {
    mesh.positions.insert(mesh.positions.end(), row.begin(), row.end());
  }
  for (std::uint32_t i = 0; i + 1 < places.size(); ++i) {
    for (std::uint32_t j = 0; j + 1 < columns; ++j) {
      const std::uint32_t here = i * columns + j, beyond = here + columns;
      mesh.indices.insert(mesh.indices.end(), {here, beyond, beyond + 1, here, beyond + 1, here + 1});
    }
  }
  return mesh;
}

/// corner + a * i/cells + b * j/cells, facing along a x b.
TriangleMesh divided_quad(const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b, int cells) {
  std::vector<std::vector<glm::vec3>> places;
  for (int i = 0; i <= cells; ++i) {
    places.emplace_back();
    for (int j = 0; j <= cells; ++j) {
      const auto n = static_cast<float>(cells);
      places.back().push_back(corner + a * (static_cast<float>(i) / n) + b * (static_cast<float>(j) / n));
    }
  }
  return grid_of(places);
}

void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const std::uint32_t index : other.indices) {
    mesh.indices.push_back(first + index);
  }
}

/// From the origin to (2, 3, 1), 8 cells to a side: all places are exact in floats.
TriangleMesh divided_box() {
  constexpr int cells = 8;
  const glm::vec3 x(2, 0, 0), y(0, 3, 0), z(0, 0, 1), none(0);
  TriangleMesh box = divided_quad(none, y, x, cells);
  append(box, divided_quad(z, x, y, cells));
  append(box, divided_quad(none, x, z, cells));
  append(box, divided_quad(y, z, x, cells));
  append(box, divided_quad(none, z, y, cells));
  append(box, divided_quad(x, y, z, cells));
  return box;
}

/// 4 m by 4 m in 16 by 16 cells, without the middle 2 m by 2 m.
TriangleMesh plate_with_hole() {
  TriangleMesh plate = divided_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 16);
  TriangleMesh holed;
  holed.positions = plate.positions;
  for (std::size_t i = 0; i < plate.indices.size(); i += 3) {
    glm::vec3 centre(0);
    for (std::size_t k = 0; k < 3; ++k) {
      centre += plate.positions[plate.indices[i + k]] / 3.0F;
    }
    if (std::max(std::abs(centre.x), std::abs(centre.y)) > 1) {
      const auto from = plate.indices.begin() + static_cast<std::ptrdiff_t>(i);
      holed.indices.insert(holed.indices.end(), from, from + 3);
    }
  }
  return holed;
}

/// Closed at both ends by fans around their centres. Its wall has `around` plane strips.
TriangleMesh tube(int around, int along) {
  std::vector<std::vector<glm::vec3>> places;
  for (int i = 0; i <= around; ++i) {
    const double angle = 2 * std::numbers::pi * (i % around) / around;
    places.emplace_back();
    for (int j = 0; j <= along; ++j) {
      places.back().emplace_back(std::cos(angle), std::sin(angle), static_cast<float>(j) / 8);
    }
  }
  TriangleMesh mesh = grid_of(places);
  const auto row = static_cast<std::uint32_t>(along + 1);
  const auto centre = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.emplace_back(0, 0, 0);
  mesh.positions.emplace_back(0, 0, static_cast<float>(along) / 8);
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(around); ++i) {
    const std::uint32_t here = i * row, next = here + row;
    mesh.indices.insert(mesh.indices.end(), {centre, next, here});
    mesh.indices.insert(mesh.indices.end(), {centre + 1, here + row - 1, next + row - 1});
  }
  return mesh;
}

/// Strips of 1 m along y, each turned by `step_rad` from the last: an arc of a circle above x, to the
/// precision of floats.
TriangleMesh bent_sheet(int strips, double strip_m, double step_rad, int cells_along) {
  std::vector<std::vector<glm::vec3>> places;
  double x = 0.0, z = 0.0;
  for (int i = 0; i <= strips; ++i) {
    places.emplace_back();
    for (int j = 0; j <= cells_along; ++j) {
      places.back().emplace_back(x, static_cast<float>(j) / static_cast<float>(cells_along), z);
    }
    x += strip_m * std::cos(i * step_rad);
    z += strip_m * std::sin(i * step_rad);
  }
  return grid_of(places);
}

/// Every facet with three vertices of its own.
TriangleMesh unwelded(const TriangleMesh& mesh) {
  TriangleMesh apart;
  for (const std::uint32_t index : mesh.indices) {
    apart.indices.push_back(static_cast<std::uint32_t>(apart.positions.size()));
    apart.positions.push_back(mesh.positions[index]);
  }
  return apart;
}

/// Turned about an axis that is parallel to nothing, and away from the origin, then rounded to floats.
TriangleMesh moved(TriangleMesh mesh) {
  const glm::dquat turn = glm::angleAxis(0.83, glm::normalize(glm::dvec3(0.36, -0.48, 0.8)));
  for (glm::vec3& p : mesh.positions) {
    p = glm::vec3(turn * glm::dvec3(p) + glm::dvec3(20, -30, 5));
  }
  return mesh;
}

/// Expects that a merged mesh has corners of the original only, facets with areas, and no vertex attributes.
void expect_sound(const TriangleMesh& merged, const TriangleMesh& original) {
  const std::set<Place> before = corners_of(original), after = corners_of(merged);
  EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
  EXPECT_EQ(merged.indices.size() % 3, 0u);
  EXPECT_TRUE(merged.normals.empty() && merged.texcoords.empty() && merged.tangents.empty());
  for (const Facet& facet : facets_of(merged)) {
    EXPECT_GT(glm::length(area_vector(facet)), 0.0);
  }
}

void expect_two_triangles(const TriangleMesh& divided) {
  const TriangleMesh merged = merge_coplanar_facets(divided);
  expect_sound(merged, divided);
  EXPECT_EQ(merged.triangle_count(), 2u);
  EXPECT_EQ(corners_of(merged), (std::set<Place>{{1, 2, 3}, {7, 2, 3}, {1, 7, 3}, {7, 7, 3}}));
  EXPECT_NEAR(area_of(merged), 30.0, 1e-5);
  EXPECT_NEAR(border_length(merged), 22.0, 1e-5);
  for (const Facet& facet : facets_of(merged)) {
    EXPECT_EQ(normal_of(facet), glm::dvec3(0, 0, 1));
  }
}

TEST(CoplanarFacets, QuadBecomesTwoTriangles) {
  for (const int cells : {1, 2, 7, 20, 100}) {
    const TriangleMesh quad = divided_quad({1, 2, 3}, {6, 0, 0}, {0, 5, 0}, cells);
    expect_two_triangles(quad);
    expect_two_triangles(unwelded(quad));
  }
}

TEST(CoplanarFacets, SoDoesOneThatIsDividedUnevenly) {
  constexpr std::size_t cells = 30;
  TriangleMesh quad = divided_quad({1, 2, 3}, {6, 0, 0}, {0, 5, 0}, cells);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> shift(-0.05F, 0.05F);
  for (std::size_t i = 1; i < cells; ++i) {
    for (std::size_t j = 1; j < cells; ++j) {
      quad.positions[i * (cells + 1) + j] += glm::vec3(shift(random), shift(random), 0);
    }
  }
  expect_two_triangles(quad);
}

void expect_box(const TriangleMesh& divided) {
  const TriangleMesh merged = merge_coplanar_facets(divided);
  expect_sound(merged, divided);
  EXPECT_EQ(merged.triangle_count(), 12u);
  EXPECT_EQ(corners_of(merged).size(), 8u);
  EXPECT_TRUE(is_closed(merged));
  EXPECT_NEAR(area_of(merged), 22.0, 1e-4);
}

/// The same places, some zeros with a sign.
TriangleMesh with_negative_zeros(TriangleMesh mesh) {
  for (std::size_t i = 0; i < mesh.positions.size(); i += 2) {
    for (int axis = 0; axis < 3; ++axis) {
      float& at = mesh.positions[i][axis];
      at = at == 0.0F ? -0.0F : at;
    }
  }
  return mesh;
}

TEST(CoplanarFacets, BoxBecomesTwelveTriangles) {
  ASSERT_TRUE(is_closed(divided_box()));
  for (const TriangleMesh& box :
       {divided_box(), unwelded(divided_box()), with_negative_zeros(unwelded(divided_box()))}) {
    expect_box(box);
    expect_box(moved(box));
    EXPECT_NEAR(volume_of(merge_coplanar_facets(box)), 6.0, 1e-5);
  }
}

TEST(CoplanarFacets, WindingIsKept) {
  TriangleMesh inside_out = divided_box();
  for (std::size_t i = 0; i < inside_out.indices.size(); i += 3) {
    std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
  }
  expect_box(inside_out);
  EXPECT_NEAR(volume_of(merge_coplanar_facets(inside_out)), -6.0, 1e-5);
}

void expect_plate_with_hole(const TriangleMesh& divided) {
  const TriangleMesh merged = merge_coplanar_facets(divided);
  expect_sound(merged, divided);
  // An annulus has as many triangles as corners: eight.
  EXPECT_EQ(corners_of(merged).size(), 8u);
  EXPECT_EQ(merged.triangle_count(), 8u);
  EXPECT_NEAR(area_of(merged), 12.0, 1e-4);
  EXPECT_NEAR(border_length(merged), 16.0 + 8.0, 1e-4);
}

TEST(CoplanarFacets, HolesStayOpen) {
  expect_plate_with_hole(plate_with_hole());
  expect_plate_with_hole(unwelded(plate_with_hole()));
  expect_plate_with_hole(moved(plate_with_hole()));
  for (const Facet& facet : facets_of(merge_coplanar_facets(plate_with_hole()))) {
    const glm::dvec3 centre = centre_of(facet);
    EXPECT_GT(std::max(std::abs(centre.x), std::abs(centre.y)), 1.0);
    EXPECT_EQ(normal_of(facet), glm::dvec3(0, 0, 1));
  }
}

// 24 strips of width 2 sin 7.5 degrees and 5 m long, and two 24-gons.
TEST(CoplanarFacets, TubeKeepsItsCrossSection) {
  const TriangleMesh divided = tube(24, 40);
  ASSERT_TRUE(is_closed(divided));
  const double angle = 2 * std::numbers::pi / 24;
  const double area = 24 * (5 * 2 * std::sin(angle / 2) + std::sin(angle));
  for (const TriangleMesh& mesh : {divided, unwelded(divided)}) {
    const TriangleMesh merged = merge_coplanar_facets(mesh);
    expect_sound(merged, mesh);
    EXPECT_TRUE(is_closed(merged));
    EXPECT_EQ(corners_of(merged).size(), 2u * 24u);
    EXPECT_EQ(merged.triangle_count(), 2u * 24u + 2u * 22u);
    EXPECT_NEAR(area_of(merged), area, 1e-5);
    EXPECT_NEAR(volume_of(merged), 5 * 12 * std::sin(angle), 1e-5);
  }
}

TEST(CoplanarFacets, BallStaysAsItIs) {
  for (const int n : {8, 16, 64}) {
    const TriangleMesh ball = test::make_sphere(0.5F, n);
    for (const TriangleMesh& mesh : {ball, unwelded(ball), moved(ball)}) {
      EXPECT_EQ(places_of_facets(merge_coplanar_facets(mesh)), places_of_facets(mesh)) << n;
    }
  }
}

// Strips so narrow that only their angle distinguishes them, and wide ones.
TEST(CoplanarFacets, BendsAreKept) {
  for (const double strip_m : {0.02, 0.25}) {
    const TriangleMesh narrow = bent_sheet(100, strip_m, 3e-4, 1);
    EXPECT_EQ(places_of_facets(merge_coplanar_facets(narrow)), places_of_facets(narrow));
    // Divided along the bends as well: these are straight, so one cell is left of each strip.
    const TriangleMesh wide = bent_sheet(100, strip_m, 3e-4, 4);
    const TriangleMesh merged = merge_coplanar_facets(wide);
    expect_sound(merged, wide);
    EXPECT_EQ(corners_of(merged), corners_of(narrow));
    EXPECT_EQ(merged.triangle_count(), 200u);
    EXPECT_NEAR(area_of(merged), 100 * strip_m, 1e-4);
  }
}

/// Expects that no facet is turned at its corners against the arc of bent_sheet() by more than allowed. A
/// facet and the facets it replaces lie within flat_rad of one facet's plane, and the arc turns by half a
/// step within each. The rest is rounding.
void expect_along_arc(const TriangleMesh& merged, double strip_m, double step_rad) {
  for (const Facet& facet : facets_of(merged)) {
    const glm::dvec3 normal = normal_of(facet);
    for (const glm::dvec3& corner : facet) {
      // x = R sin(angle), R = strip_m / step_rad; the first strip is level.
      const double angle = std::asin(corner.x * step_rad / strip_m) - step_rad / 2;
      EXPECT_NEAR(std::atan2(-normal.x, normal.z), angle, 2 * flat_rad + step_rad / 2 + 2e-5);
      EXPECT_NEAR(normal.y, 0.0, 2 * flat_rad);
    }
  }
}

// Each facet differs from the next by less than flat_rad, but the sheet is curved.
TEST(CoplanarFacets, GentleCurvesAreKept) {
  constexpr double step_rad = 0.8e-4;
  constexpr int strips = 1250;
  for (const double strip_m : {0.02, 0.25}) {
    for (const int cells_along : {1, 4}) {
      const TriangleMesh sheet = bent_sheet(strips, strip_m, step_rad, cells_along);
      const TriangleMesh merged = merge_coplanar_facets(sheet);
      expect_sound(merged, sheet);
      EXPECT_LT(merged.triangle_count(), sheet.triangle_count());
      EXPECT_NEAR(area_of(merged), strips * strip_m, 1e-4);
      EXPECT_NEAR(border_length(merged), 2 * (strips * strip_m + 1), 1e-4);
      expect_along_arc(merged, strip_m, step_rad);
    }
  }
}

double distance_to_side(const glm::dvec3& p, const glm::dvec3& from, const glm::dvec3& to) {
  const glm::dvec3 whole = to - from;
  const double way = std::clamp(glm::dot(p - from, whole) / glm::dot(whole, whole), 0.0, 1.0);
  return glm::length(p - from - whole * way);
}

/// Largest shift, m, of the border of a sector of a disc. Each of the `steps` sides of its arc is `growth`
/// times as long as the last one.
double border_shift(double radius_m, double arc_rad, int steps, double growth) {
  const double whole = growth == 1.0 ? steps : (std::pow(growth, steps) - 1) / (growth - 1);
  TriangleMesh sector;
  sector.positions.emplace_back(0, 0, 0);
  double gone = 0.0;
  for (int i = 0; i <= steps; ++i) {
    const double angle = arc_rad * gone / whole;
    sector.positions.emplace_back(radius_m * std::cos(angle), radius_m * std::sin(angle), 0);
    gone += std::pow(growth, i);
  }
  for (std::uint32_t i = 1; i + 1 < sector.positions.size(); ++i) {
    sector.indices.insert(sector.indices.end(), {0, i, i + 1});
  }
  const TriangleMesh merged = merge_coplanar_facets(sector);
  expect_sound(merged, sector);
  EXPECT_LE(merged.triangle_count(), sector.triangle_count() / 2);
  double worst = 0.0;
  for (const glm::vec3& before : sector.positions) {
    double nearest = radius_m;
    for (const auto& [from, to] : border_of(merged)) {
      nearest = std::min(nearest, distance_to_side(glm::dvec3(before), from, to));
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

/// `flat_m` and the rounding of the positions, times 4/3: the side that a removed vertex leaves may be
/// removed too, and a side half as long deviates by a quarter.
double allowed_shift(double radius_m) {
  return 4.0 / 3 * (flat_m + radius_m * 0x1p-23);
}

TEST(CoplanarFacets, CurvedBordersAreKept) {
  EXPECT_LT(border_shift(1, 1.0, 800, 1.0), allowed_shift(1));
  EXPECT_LT(border_shift(10, 0.1, 1000, 1.0), allowed_shift(10));
  EXPECT_LT(border_shift(30, 0.2, 1000, 1.0), allowed_shift(30));
}

// If each vertex were compared with its present neighbours only, not with those removed before, the border
// would move by 0.2 mm.
TEST(CoplanarFacets, CurvedBordersOfUnevenStepsAreKept) {
  EXPECT_LT(border_shift(30, 0.2, 800, 1 / 1.005), allowed_shift(30));
}

TEST(CoplanarFacets, ThreeSheetsAtOneEdgeKeepTheirAreas) {
  TriangleMesh sheets;
  const glm::vec3 edge(0, 0, 2);
  for (const glm::vec3& side : {glm::vec3(3, 0, 0), glm::vec3(0, 1, 0), glm::vec3(-4, -3, 0)}) {
    append(sheets, divided_quad({0, 0, 0}, side, edge, 16));
  }
  for (const TriangleMesh& mesh : {sheets, unwelded(sheets), moved(sheets)}) {
    const TriangleMesh merged = merge_coplanar_facets(mesh);
    expect_sound(merged, mesh);
    EXPECT_LT(merged.triangle_count(), mesh.triangle_count() / 4);
    EXPECT_NEAR(area_of(merged), 2 * (3 + 1 + 5), 1e-4);
    EXPECT_NEAR(border_length(merged), border_length(mesh), 1e-4);
  }
}

// Both sides of a plate, back to back.
TEST(CoplanarFacets, FacetsBackToBackKeepBothSides) {
  TriangleMesh plate = divided_quad({0, 0, 0}, {4, 0, 0}, {0, 2, 0}, 8);
  append(plate, divided_quad({0, 0, 0}, {0, 2, 0}, {4, 0, 0}, 8));
  const TriangleMesh merged = merge_coplanar_facets(plate);
  expect_sound(merged, plate);
  double up = 0.0, down = 0.0;
  for (const Facet& facet : facets_of(merged)) {
    (area_vector(facet).z > 0 ? up : down) += area_vector(facet).z;
  }
  EXPECT_NEAR(up, 8.0, 1e-6);
  EXPECT_NEAR(down, -8.0, 1e-6);
}

TEST(CoplanarFacets, FacetsWithoutAreaDoNoHarm) {
  TriangleMesh quad = divided_quad({1, 2, 3}, {6, 0, 0}, {0, 5, 0}, 20);
  const std::uint32_t last = static_cast<std::uint32_t>(quad.positions.size()) - 1;
  quad.indices.insert(quad.indices.end(), {30, 30, 31, 5, 5, 5, last, last - 1, last});  // repeated corners
  expect_two_triangles(quad);
  quad.indices.insert(quad.indices.end(), {44, 45, 46, 0, 1, 2, 100, 121, 142});  // in a line
  const TriangleMesh merged = merge_coplanar_facets(quad);
  EXPECT_NEAR(area_of(merged), 30.0, 1e-5);
  EXPECT_LT(merged.triangle_count(), 100u);
  for (const glm::vec3& p : merged.positions) {
    EXPECT_EQ(p.z, 3.0F);
  }
}

TEST(CoplanarFacets, NothingIsMadeOfNothing) {
  EXPECT_EQ(merge_coplanar_facets({}).triangle_count(), 0u);
  TriangleMesh points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_EQ(merge_coplanar_facets(points).triangle_count(), 0u);
  points.indices = {0, 0, 0, 1, 1, 2};
  EXPECT_EQ(area_of(merge_coplanar_facets(points)), 0.0);
  points.indices = {0, 1, 2};
  EXPECT_EQ(places_of_facets(merge_coplanar_facets(points)), places_of_facets(points));
}

// Each plane compared is the plane of one facet. Corners 30 m away are rounded by 1e-6 m. Over the plate
// this tilts the plane of one cell by 1e-6 m for every cell, and by no more than `flat_m` for 16 of them.
TEST(CoplanarFacets, PlatesInAnyAttitudeMergeToAFewTriangles) {
  for (const int cells : {2, 4, 8, 16, 32, 64}) {
    const TriangleMesh plate = moved(divided_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, cells));
    const TriangleMesh merged = merge_coplanar_facets(plate);
    expect_sound(merged, plate);
    EXPECT_LE(merged.triangle_count(), cells <= 16 ? 4u : plate.triangle_count() / 32) << cells << " cells";
    EXPECT_NEAR(area_of(merged), 4.0, 1e-5);
    EXPECT_NEAR(border_length(merged), 8.0, 1e-5);
  }
}

}  // namespace
}  // namespace sonard::render
