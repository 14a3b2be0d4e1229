// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_meshes.hpp"

#include <set>

#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/records.hpp"

namespace sonard::render {

namespace {

using records::Cluster;
using records::ClusterTriangle;

constexpr std::size_t vertex_bytes = 3 * sizeof(float);

}  // namespace

std::uint64_t GpuMeshes::Sizes::bytes() const {
  return vertices * vertex_bytes + triangles * sizeof(ClusterTriangle) + clusters * sizeof(Cluster);
}

bool GpuMeshes::Sizes::within(const Sizes& room) const {
  return vertices <= room.vertices && triangles <= room.triangles && clusters <= room.clusters;
}

GpuMeshes::Sizes GpuMeshes::Sizes::operator+(const Sizes& more) const {
  return {vertices + more.vertices, triangles + more.triangles, clusters + more.clusters};
}

GpuMeshes::Sizes GpuMeshes::sizes_of(const MeshClusters& mesh) {
  return {mesh.x.size(), mesh.mesh_triangle.size(), mesh.clusters.size()};
}

void GpuMeshes::hold(const std::vector<std::shared_ptr<const MeshClusters>>& meshes,
                     std::uint64_t beside_bytes) {
  const std::set<std::shared_ptr<const MeshClusters>> needed(meshes.begin(), meshes.end());
  Sizes all, missing;
  for (const auto& mesh : needed) {
    all = all + sizes_of(*mesh);
    missing = held_.contains(mesh) ? missing : missing + sizes_of(*mesh);
  }
  check_video_memory(all.bytes() + beside_bytes, bound_bytes_);
  if (!(used_ + missing).within(room_)) {
    start_again(all, beside_bytes);
  }
  for (const auto& mesh : meshes) {  // in the order of the world, which is the same in every run
    if (!held_.contains(mesh)) {
      held_[mesh] = upload(*mesh);
    }
  }
  check_upload(bytes());
}

/// Drops all meshes, and makes room for these: and for as many again, if the bound allows it and earlier ones
/// were held.
void GpuMeshes::start_again(const Sizes& needed, std::uint64_t beside_bytes) {
  const Sizes twice = needed + needed;
  room_ = !held_.empty() && twice.bytes() + beside_bytes <= bound_bytes_ ? twice : needed;
  used_ = {};
  held_.clear();
  vertices_.allocate(room_.vertices * vertex_bytes);
  triangles_.allocate(room_.triangles * sizeof(ClusterTriangle));
  clusters_.allocate(room_.clusters * sizeof(Cluster));
}

std::uint32_t GpuMeshes::upload(const MeshClusters& mesh) {
  std::vector<float> vertices;
  for (std::size_t v = 0; v < mesh.x.size(); ++v) {
    vertices.insert(vertices.end(), {mesh.x[v], mesh.y[v], mesh.z[v]});
  }
  std::vector<ClusterTriangle> triangles;
  for (std::size_t t = 0; t < mesh.mesh_triangle.size(); ++t) {
    const std::uint32_t corners = mesh.corners[0][t] | std::uint32_t{mesh.corners[1][t]} << 8U |
                                  std::uint32_t{mesh.corners[2][t]} << 16U;
    triangles.push_back({corners, mesh.mesh_triangle[t], mesh.shell[t]});
  }
  std::vector<Cluster> clusters;
  const auto vertex = static_cast<std::uint32_t>(used_.vertices),
             triangle = static_cast<std::uint32_t>(used_.triangles);
  for (const MeshClusters::Cluster& c : mesh.clusters) {
    clusters.push_back({c.centre_m.x, c.centre_m.y, c.centre_m.z, c.radius_m, vertex + c.first_vertex,
                        c.vertex_count, triangle + c.first_triangle, c.triangle_count});
  }
  vertices_.write(vertices, used_.vertices * vertex_bytes);
  triangles_.write(triangles, used_.triangles * sizeof(ClusterTriangle));
  clusters_.write(clusters, used_.clusters * sizeof(Cluster));
  const auto first = static_cast<std::uint32_t>(used_.clusters);
  used_ = used_ + sizes_of(mesh);
  bytes_uploaded_ += sizes_of(mesh).bytes();
  return first;
}

}  // namespace sonard::render
