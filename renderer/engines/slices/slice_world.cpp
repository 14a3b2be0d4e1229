// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/slices/slice_world.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <glm/geometric.hpp>

#include "renderer/scene/coplanar_facets.hpp"

namespace sonard::render {

namespace {

/// True if all vertex normals equal the normals of their facets, to 1e-4 rad, or if there are no vertex
/// normals: then interpolation is not needed.
bool has_plain_facets(const TriangleMesh& mesh) {
  constexpr float plain_rad = 1e-4F;
  for (std::size_t i = 0; i + 2 < mesh.indices.size() && !mesh.normals.empty(); i += 3) {
    const std::uint32_t* corner = &mesh.indices[i];
    const glm::vec3 edge_b = mesh.positions[corner[1]] - mesh.positions[corner[0]];
    const glm::vec3 edge_c = mesh.positions[corner[2]] - mesh.positions[corner[0]];
    const glm::vec3 facet = glm::normalize(glm::cross(edge_b, edge_c));
    for (std::size_t k = 0; k < 3; ++k) {
      // Negated, so that NaN returns false.
      if (!(glm::length(glm::cross(facet, mesh.normals[corner[k]])) < plain_rad)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

/// Meshes and normal maps that parts share; each is prepared once.
struct SliceWorld::Prepared {
  struct Shape {
    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const MeshClusters> clusters;
    std::uint64_t merged_facets = 0;
  };
  std::map<std::pair<const TriangleMesh*, bool>, Shape> shapes;  ///< unchanged (false) or merged (true)
  std::map<const NormalMap*, std::shared_ptr<const NormalPyramid>> pyramids;

  const Shape& shape(const std::shared_ptr<const TriangleMesh>& mesh, bool merge, const SkipSwitches& skip) {
    Shape& shape = shapes[{mesh.get(), merge}];
    if (!shape.mesh) {
      shape.mesh = mesh;
      if (merge) {
        TriangleMesh merged = merge_coplanar_facets(*mesh);
        shape.merged_facets = mesh->triangle_count() - merged.triangle_count();
        if (shape.merged_facets > 0) {  // otherwise the original mesh is used
          shape.mesh = std::make_shared<const TriangleMesh>(std::move(merged));
        }
      }
      shape.clusters = std::make_shared<const MeshClusters>(*shape.mesh, skip.on(SkipRule::hidden_faces));
    }
    return shape;
  }
  /// @param map null: a map without bumps
  std::shared_ptr<const NormalPyramid> pyramid(const NormalMap* map) {
    auto& pyramid = pyramids[map];
    if (!pyramid) {
      pyramid = std::make_shared<const NormalPyramid>(map ? NormalPyramid(*map) : NormalPyramid::straight());
    }
    return pyramid;
  }
};

SliceWorld::SliceWorld(const World& world, const SkipSwitches& skip) : skip_(skip) {
  Prepared prepared;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      add_part(part, prepared);
    }
    T_world_body_.push_back(body.T_world_body);
  }
}

SkipSwitches slice_switches(const RendererOptions& options) {
  SkipSwitches switches = options.skip;
  return options.ray_curvature_per_m == 0.0 ? switches : switches.turn_off(SkipRule::coplanar_facets);
}

bool SliceWorld::any_vertex_normals() const {
  return std::any_of(surfaces_.begin(), surfaces_.end(),
                     [](const PartSurface& part) { return part.vertex_normals; });
}

/// Adds a part of the next body.
void SliceWorld::add_part(const BodyPart& part, Prepared& prepared) {
  PartSurface surface;
  surface.backscatter = Backscatter(part.material);
  surface.reflectance = static_cast<float>(part.material.reflectance);
  if (surface.backscatter.facet_strength > 0) {
    any_facets_ = true;
  }
  surface.vertex_normals = !(skip_.on(SkipRule::geometric_normals) && has_plain_facets(*part.mesh));
  skipped_.add(SkipRule::geometric_normals, surface.vertex_normals ? 0 : 1);
  if (!part.normal_map && skip_.on(SkipRule::absent_normal_map)) {
    skipped_.add(SkipRule::absent_normal_map);
  } else if (part.mesh->can_be_mapped()) {
    surface.normal_map = prepared.pyramid(part.normal_map.get());
    any_mapped_ = true;
  }
  // Of a facet that is shaded by its own normal, only the plane matters.
  const bool merge = !surface.vertex_normals && !surface.normal_map && skip_.on(SkipRule::coplanar_facets);
  const Prepared::Shape& shape = prepared.shape(part.mesh, merge, skip_);
  skipped_.add(SkipRule::coplanar_facets, shape.merged_facets);
  surface.mesh = shape.mesh;
  parts_.push_back({T_world_body_.size(), part.T_body_part});
  placed_.push_back({shape.clusters, {}, {}});
  surfaces_.push_back(std::move(surface));
}

/// Facets of changed parts are not merged, because neighbouring parts share corners.
void SliceWorld::set_part_meshes(std::span<const PartMesh> changes, WorkerPool& workers) {
  ++version_;
  std::vector<Replacement> replacements(changes.size());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    if (const Replacement* known = replacements_.find(changes[i].mesh.get())) {
      replacements[i] = *known;
    }
  }
  workers.run(static_cast<int>(changes.size()), [&](int i) {
    const TriangleMesh& mesh = *changes[static_cast<std::size_t>(i)].mesh;
    Replacement& replacement = replacements[static_cast<std::size_t>(i)];
    if (!replacement.clusters) {
      const bool plain = skip_.on(SkipRule::geometric_normals) && has_plain_facets(mesh);
      replacement = {std::make_shared<const MeshClusters>(mesh, /*find_shells=*/false), !plain};
    }
  });
  for (std::size_t i = 0; i < changes.size(); ++i) {
    placed_[changes[i].part].clusters = replacements[i].clusters;
    surfaces_[changes[i].part].mesh = changes[i].mesh;
    surfaces_[changes[i].part].vertex_normals = replacements[i].vertex_normals;
    replacements_.keep(changes[i].mesh, replacements[i]);
  }
}

/// Computes poses relative to the sonar in doubles, so that no world coordinate is rounded to a float.
void SliceWorld::place(const Pose& T_world_sonar) {
  bend_.up = glm::vec3(glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1));
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Pose T_sonar_part = relative(T_world_sonar, T_world_body_[parts_[i].body]) * parts_[i].T_body_part;
    placed_[i].R_sonar_part = glm::mat3(glm::mat3_cast(T_sonar_part.orientation));
    placed_[i].t_sonar_part_m = glm::vec3(T_sonar_part.position_m);
    surfaces_[i].R_part_sonar = glm::transpose(placed_[i].R_sonar_part);
    surfaces_[i].refraction_in_part = {surfaces_[i].R_part_sonar * bend_.up, bend_.per_m};
  }
}

}  // namespace sonard::render
