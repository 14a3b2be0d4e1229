// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/mesh_clusters.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace sonard::render {

namespace {

constexpr float morton_cells = 2097151.0F;  // 2^21 - 1, so that three interleaved axes fit in 64 bits
constexpr std::int32_t not_in_cluster = -1;

/// Puts two zero bits between the lowest 21 bits of v.
std::uint64_t spread_bits(std::uint64_t v) {
  v = (v | v << 32) & 0x001F00000000FFFFULL;
  v = (v | v << 16) & 0x001F0000FF0000FFULL;
  v = (v | v << 8) & 0x100F00F00F00F00FULL;
  v = (v | v << 4) & 0x10C30C30C30C30C3ULL;
  return (v | v << 2) & 0x1249249249249249ULL;
}

glm::vec3 centroid(const TriangleMesh& mesh, std::size_t triangle) {
  const std::uint32_t* corner = &mesh.indices[triangle * 3];
  return (mesh.positions[corner[0]] + mesh.positions[corner[1]] + mesh.positions[corner[2]]) / 3.0F;
}

/// Triangle numbers along the Morton curve through their centroids.
std::vector<std::uint32_t> morton_order(const TriangleMesh& mesh) {
  glm::vec3 low(std::numeric_limits<float>::max());
  glm::vec3 high(std::numeric_limits<float>::lowest());
  for (const glm::vec3& p : mesh.positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::vec3 size = high - low;
  const float longest = std::max({size.x, size.y, size.z});
  const float scale = longest > 0 ? morton_cells / longest : 0.0F;
  std::vector<std::uint64_t> code(mesh.triangle_count());
  for (std::size_t t = 0; t < code.size(); ++t) {
    const glm::vec3 cell = glm::clamp((centroid(mesh, t) - low) * scale, 0.0F, morton_cells);
    code[t] = spread_bits(static_cast<std::uint64_t>(cell.x)) |
              spread_bits(static_cast<std::uint64_t>(cell.y)) << 1 |
              spread_bits(static_cast<std::uint64_t>(cell.z)) << 2;
  }
  std::vector<std::uint32_t> order(code.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return code[a] < code[b]; });
  return order;
}

}  // namespace

MeshClusters::MeshClusters(const TriangleMesh& mesh, bool find_shells)
    : shells(find_shells ? Shells(mesh) : Shells()) {
  const std::vector<std::uint32_t> order = morton_order(mesh);
  for (auto& corner : corners) {
    corner.reserve(order.size());
  }
  mesh_triangle.reserve(order.size());
  std::vector<std::int32_t> local_of_vertex(mesh.positions.size(), not_in_cluster);
  for (std::size_t next = 0; next < order.size();) {
    add_cluster(mesh, order, next, local_of_vertex);
  }
  find_sphere();
  shell.resize(mesh_triangle.size(), Shells::none);
  if (find_shells) {
    std::ranges::transform(mesh_triangle, shell.begin(),
                           [&](std::uint32_t triangle) { return shells.of_triangle(triangle); });
  }
}

void MeshClusters::add_cluster(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order,
                               std::size_t& next, std::vector<std::int32_t>& local_of_vertex) {
  Cluster cluster;
  cluster.first_vertex = static_cast<std::uint32_t>(x.size());
  cluster.first_triangle = static_cast<std::uint32_t>(mesh_triangle.size());
  std::vector<std::uint32_t> used;
  while (next < order.size() && cluster.triangle_count < most_triangles && used.size() + 3 <= most_vertices) {
    const std::uint32_t triangle = order[next++];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.indices[std::size_t{triangle} * 3 + k];
      if (local_of_vertex[vertex] == not_in_cluster) {
        local_of_vertex[vertex] = static_cast<std::int32_t>(used.size());
        used.push_back(vertex);
        x.push_back(mesh.positions[vertex].x);
        y.push_back(mesh.positions[vertex].y);
        z.push_back(mesh.positions[vertex].z);
      }
      corners[k].push_back(static_cast<std::uint8_t>(local_of_vertex[vertex]));
    }
    mesh_triangle.push_back(triangle);
    ++cluster.triangle_count;
  }
  cluster.vertex_count = static_cast<std::uint32_t>(used.size());
  for (const std::uint32_t vertex : used) {
    local_of_vertex[vertex] = not_in_cluster;
  }
  close_cluster(cluster);
  clusters.push_back(cluster);
}

/// Sets the bounding sphere, centred in the bounding box.
void MeshClusters::close_cluster(Cluster& cluster) const {
  const std::size_t begin = cluster.first_vertex;
  const std::size_t end = begin + cluster.vertex_count;
  glm::vec3 low(x[begin], y[begin], z[begin]);
  glm::vec3 high = low;
  for (std::size_t i = begin; i < end; ++i) {
    low = glm::min(low, glm::vec3(x[i], y[i], z[i]));
    high = glm::max(high, glm::vec3(x[i], y[i], z[i]));
  }
  cluster.centre_m = (low + high) * 0.5F;
  for (std::size_t i = begin; i < end; ++i) {
    cluster.radius_m =
        std::max(cluster.radius_m, glm::distance(cluster.centre_m, glm::vec3(x[i], y[i], z[i])));
  }
}

void MeshClusters::find_sphere() {
  if (clusters.empty()) {
    return;
  }
  glm::vec3 low(clusters[0].centre_m), high = low;
  for (const Cluster& cluster : clusters) {
    low = glm::min(low, cluster.centre_m - cluster.radius_m);
    high = glm::max(high, cluster.centre_m + cluster.radius_m);
  }
  centre_m = (low + high) * 0.5F;
  for (const Cluster& cluster : clusters) {
    radius_m = std::max(radius_m, glm::distance(centre_m, cluster.centre_m) + cluster.radius_m);
  }
}

bool PlacedPart::misses(const Fan& fan, const Refraction& bend) const {
  const glm::vec3 centre_m = R_sonar_part * clusters->centre_m + t_sonar_part_m;
  const float spread_m = bend.straight() ? 0.0F : bend.spread_m(centre_m, clusters->radius_m);
  const glm::vec3 at_m = bend.straight() ? centre_m : bend.point(centre_m);
  return fan.misses(at_m, clusters->radius_m + spread_m) ||
         fan.is_behind(at_m, clusters->radius_m + spread_m);
}

slices::Placement PlacedPart::placement() const {
  const glm::mat3& m = R_sonar_part;  // columns are the axes of the part
  const glm::vec3& t = t_sonar_part_m;
  return {m[0].x, m[1].x, m[2].x, t.x, m[0].y, m[1].y, m[2].y, t.y, m[0].z, m[1].z, m[2].z, t.z};
}

void PlacedPart::append_hiding(bool may_hide, std::vector<float>& outwards) const {
  const glm::vec3 sonar_m = glm::transpose(R_sonar_part) * -t_sonar_part_m;
  for (const Shell& shell : clusters->shells.all()) {
    outwards.push_back(may_hide && shell.hides_inner_side(sonar_m) ? shell.outwards : 0.0F);
  }
}

}  // namespace sonard::render
