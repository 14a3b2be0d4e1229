// SPDX-License-Identifier: Apache-2.0
// A world as slices see it, for both engines.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "renderer/engines/slices/mesh_clusters.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/pose.hpp"
#include "renderer/renderer_options.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/surface/surface_model.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The rules for a SliceWorld: facets that were divided so that they bend with the rays stay apart.
SkipSwitches slice_switches(const RendererOptions& options);

/// The parts of all bodies: their meshes in clusters, their surfaces, and their places in a ping.
class SliceWorld {
 public:
  SliceWorld(const World& world, const SkipSwitches& skip);

  /// See EchoEngine::set_body_pose().
  void set_body_pose(std::size_t body, const Pose& T_world_body) { T_world_body_[body] = T_world_body; }
  /// See EchoEngine::set_part_meshes().
  void set_part_meshes(std::span<const PartMesh> changes, WorkerPool& workers);
  /// See EchoEngine::set_refraction().
  void set_refraction(double bend_per_m) { bend_.per_m = static_cast<float>(bend_per_m); }

  /// Places all parts in the frame of the sonar.
  void place(const Pose& T_world_sonar);

  // Of the last place():
  const std::vector<PlacedPart>& parts() const { return placed_; }
  const std::vector<PartSurface>& surfaces() const { return surfaces_; }  ///< of the parts
  const Refraction& bend() const { return bend_; }                        ///< in the sonar frame

  bool any_mapped() const { return any_mapped_; }  ///< some part has a normal map
  bool any_vertex_normals() const;                 ///< some part is shaded by them
  /// True if some part may answer by facets.
  bool any_facets(const SurfaceModel& model) const {
    return model.facets == Facets::everywhere || (model.facets == Facets::near_normal && any_facets_);
  }
  /// Changes with set_part_meshes().
  std::size_t version() const { return version_; }
  /// Work left out of shading in every ping.
  const SkipCounts& skipped() const { return skipped_; }

 private:
  struct Part {
    std::size_t body;
    Pose T_body_part;
  };
  struct Replacement {
    std::shared_ptr<const MeshClusters> clusters;
    bool vertex_normals = false;
  };
  struct Prepared;

  void add_part(const BodyPart& part, Prepared& prepared);

  SkipSwitches skip_;
  SkipCounts skipped_;
  std::vector<Pose> T_world_body_;
  std::vector<Part> parts_;
  std::vector<PlacedPart> placed_;
  std::vector<PartSurface> surfaces_;
  MeshCache<Replacement> replacements_;
  bool any_mapped_ = false, any_facets_ = false;
  std::size_t version_ = 0;
  Refraction bend_;
};

}  // namespace sonard::render
