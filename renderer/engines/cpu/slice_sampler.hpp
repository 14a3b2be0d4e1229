// SPDX-License-Identifier: Apache-2.0
// Exact visibility in slices of constant azimuth, refined if neighbouring slices disagree: the adaptive
// sampling of the CPU.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/cpu/slice_patches.hpp"
#include "renderer/engines/cpu/slice_sides.hpp"
#include "renderer/engines/slices/slice_accuracy.hpp"
#include "renderer/engines/slices/slice_world.hpp"
#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Disagreement of neighbouring slices on their border, as shares of the elevations, weighted by the
/// elevation pattern.
struct SliceBorder {
  float range_mismatch = 0.0F;  ///< expected ranges differ by more than a line
  float curvature = 0.0F;       ///< surfaces curve too much for straight lines across the slices
  float shift_lines = 0.0F;     ///< move of the echo's centroid that range mismatch may cause, in lines
};

/// A wedge of the fan and its visible segments.
struct SliceCell {
  Slice slice;
  int beam = 0;
  std::vector<VisibleSegment> visible;  ///< at its azimuth, independent of its width
  SliceSides sides;
  SliceBorder to_starboard;        ///< between this slice and the next one
  float missed_share = 0.0F;       ///< of the fan's height: SliceCutter::missed_height()
  bool seen = false;               ///< `visible` is filled
  bool fresh = true;               ///< not yet compared with its neighbours
  std::vector<UprightEdge> edges;  ///< within the wedge, from port to starboard
  ProbeSet edge_at_starboard;      ///< of the upright edge at which its whole was divided
};

/// Samples azimuths only: in each slice visibility and range limits are exact. Errors across slices are of
/// second order in their width, except at round silhouettes along them; errors along a slice have the limits
/// of SliceAccuracy (docs/accuracy.md). Only one thread may use it; it distributes its work over the pool.
class SliceSampler {
 public:
  SliceSampler(const World& world, WorkerPool& workers, const SkipSwitches& skip = {});
  ~SliceSampler();

  /// Cells from port to starboard; valid until the next call. The result does not depend on the number of
  /// threads.
  /// @param sampled_range_m range up to which surfaces are found; at least the range of the lines
  std::vector<const SliceCell*> sample(const Pose& T_world_sonar, const Aperture& aperture,
                                       const RangeBins& range, double sampled_range_m,
                                       const SurfaceModel& surface, const SliceAccuracy& accuracy);

  /// Makes the patches of one of these cells. Any thread may call it.
  /// @param patches gets the new patches appended
  /// @return number of segments whose facets were left out (SkipRule::facet_kernel)
  std::uint64_t make_patches(const SliceCell& cell, std::vector<EchoPatch>& patches) const;

  /// See EchoEngine::set_body_pose().
  void set_body_pose(std::size_t body, const Pose& T_world_body) { world_.set_body_pose(body, T_world_body); }

  /// See EchoEngine::set_part_meshes().
  void set_part_meshes(std::span<const PartMesh> changes) { world_.set_part_meshes(changes, workers_); }

  /// See EchoEngine::set_refraction().
  void set_refraction(double bend_per_m) { world_.set_refraction(bend_per_m); }

  /// Work that the last sample() left out.
  const SkipCounts& skipped() const { return skipped_; }

 private:
  struct Elevations;
  struct Setting;
  struct Scratch;

  const Elevations& elevations_of(const Aperture& aperture, float tan_limit);
  void lay_first_slices(const Setting& setting);
  void see(const Setting& setting, const std::vector<std::size_t>& fresh);
  static void see_cell(const Setting& setting, Scratch& scratch, SliceCell& cell);
  std::size_t new_cell(const Slice& slice, int beam);

  // slice_refinement.cpp
  void compare_neighbours(const Setting& setting);
  std::vector<float> ensonified_by_beam(const Setting& setting) const;
  std::vector<float> slices_in_error(const Setting& setting) const;
  std::vector<int> choose_parts(const Setting& setting);
  void divide(std::size_t whole_number, int parts, std::vector<std::size_t>& order,
              std::vector<std::size_t>& fresh);
  bool refine(const Setting& setting, std::vector<std::size_t>& fresh);

  WorkerPool& workers_;
  SkipSwitches skip_;
  SliceWorld world_;
  FanTriangles triangles_;
  VertexNormals vertex_normals_;                   ///< of triangles_, if a part is shaded by them
  std::vector<std::unique_ptr<SliceCell>> cells_;  ///< kept for reuse; the first cells_used_ are in use
  std::size_t cells_used_ = 0;
  std::vector<std::size_t> order_;  ///< cells from port to starboard
  SkipCounts skipped_;
  std::unique_ptr<const Elevations> elevations_;  ///< of the last call
  std::unique_ptr<const Setting> setting_;        ///< of the last call
};

}  // namespace sonard::render
