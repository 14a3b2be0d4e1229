// SPDX-License-Identifier: Apache-2.0
// Exact visibility in slices of constant azimuth, refined where neighbouring slices disagree: the adaptive
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
#include "renderer/pose.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/ray_bend.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// How closely slices follow the world: as it stands, within 1 %.
struct SliceAccuracy {
  int slices_per_beam = 1;  ///< to begin with; wide and oblique beams get more
  /// No slice is narrower than a beam divided by this, unless it lies between upright edges; 1: the first
  /// slices stay.
  int most_divisions = 125;
  /// A first slice at whose sides neighbours disagree is divided in five, even if three would do: where much
  /// is left in doubt, the ends of shadows then still reach their lines.
  bool first_in_five = false;
  /// Where neighbouring slices disagree they are divided, until of the elevations at which a beam hears
  /// anything this is the share in doubt: (share of elevations at which a slice disagrees) * (width / beam
  /// width), summed over the beam as independent errors are.
  float disagreement = 1.3e-3F;
  /// A few elevations may hold much of an echo, far from its middle: they are in doubt too while they might
  /// move the middle of the beam's echo by more than this.
  float shift_lines = 0.2F;
  /// A slice that hears n range lines may be bent by this times n lines: what a bow displaces are the first
  /// and last of them, the fewer there are the more it matters.
  float bow_lines = 6e-4F;
  float linearity = 0.03F;     ///< see SlicePatcher::Request
  float change = 0.005F;       ///< share by which a wall's echo may change within a first slice, RMS
  float mapped_lines = 2.0F;   ///< see SlicePatcher::Request
  float facet_slopes = 0.17F;  ///< see SlicePatcher::Request
  float facet_lines = 0.006F;  ///< see SlicePatcher::Request
};

/// Shares of the elevations at which neighbouring slices do not agree.
struct SliceBorder {
  float apart = 0.0F;  ///< they expect ranges more than a line apart on the border
  float bent = 0.0F;   ///< their surfaces are bent, so that a straight line across one of them is too far off
  /// By so many lines the echoes of either differ in their middle for what is apart.
  float shift_lines = 0.0F;
};

/// A wedge of the fan and what is seen in it.
struct SliceCell {
  Slice slice;
  int beam = 0;
  std::vector<VisiblePiece> pieces;  ///< seen along its azimuth, whatever its width
  std::vector<EchoPatch> patches;
  SliceSides sides;
  SliceBorder to_starboard;                  ///< between this slice and the next one
  std::uint64_t without_facets = 0;          ///< patches, see SkipRule::facet_kernel
  bool misses_something = false;             ///< a thin thing lies beside the slice and inside its wedge
  bool seen = false;                         ///< its pieces are known
  bool fresh = true;                         ///< not yet compared with its neighbours
  std::vector<UprightEdge> edges;            ///< within the wedge, from port to starboard
  ProbeSet edge_at_port, edge_at_starboard;  ///< of the upright edge for which the slice ends there
};

/// Along the elevation nothing is sampled: in each slice visibility and range limits are exact, so that only
/// the width of slices makes errors, and these of second order but at round silhouettes that run along the
/// slices (docs/accuracy.md). One thread uses it; it shares its work with the pool's.
class SliceSampler {
 public:
  SliceSampler(const World& world, WorkerPool& workers, const SkipSwitches& skip = {});

  /// Cells from port to starboard; they stay valid until the next call. The same for any number of threads.
  /// @param sampled_range_m at least that of the lines: how far surfaces are looked at.
  std::vector<const SliceCell*> sample(const Pose& T_world_sonar, const Aperture& aperture,
                                       const RangeLines& range, double sampled_range_m,
                                       const SurfaceModel& surface, const SliceAccuracy& accuracy);

  /// As EchoEngine::set_body_pose().
  void set_body_pose(std::size_t body, const Pose& T_world_body) { T_world_body_[body] = T_world_body; }

  /// As EchoEngine::set_part_meshes().
  void set_part_meshes(std::span<const PartMesh> changes);

  /// As EchoEngine::set_ray_bend().
  void set_ray_bend(double bend_per_m) { bend_.per_m = static_cast<float>(bend_per_m); }

  /// Of the last call.
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
  struct Setting;
  struct Scratch;

  void add_part(const BodyPart& part, Prepared& prepared);
  void place_parts(const Pose& T_world_sonar);
  void lay_first_slices(const Setting& setting);
  void see(const Setting& setting, const std::vector<std::size_t>& fresh);
  static void see_cell(const Setting& setting, Scratch& scratch, SliceCell& cell);
  void make_patches(const Setting& setting);
  std::size_t new_cell(const Slice& slice, int beam);

  // slice_refinement.cpp
  void compare_neighbours(const Setting& setting);
  std::vector<float> heard_by_beams(const Setting& setting) const;
  std::vector<float> doubtful_slices(const Setting& setting) const;
  std::vector<int> choose_parts(const Setting& setting);
  void divide(std::size_t whole_number, int parts, std::vector<std::size_t>& order,
              std::vector<std::size_t>& fresh);
  bool refine(const Setting& setting, std::vector<std::size_t>& fresh);

  WorkerPool& workers_;
  SkipSwitches skip_;
  SkipCounts skipped_parts_;  ///< of every ping: what is left out of shading
  std::vector<Pose> T_world_body_;
  std::vector<Part> parts_;
  std::vector<PlacedPart> placed_;
  std::vector<PartSurface> surfaces_;
  MeshCache<Replacement> replacements_;
  bool any_mapped_ = false;
  bool any_facets_ = false;  ///< whether any material has them
  RayBend bend_;             ///< in the sonar frame of this ping
  FanTriangles triangles_;
  std::vector<std::unique_ptr<SliceCell>> cells_;  ///< all ever needed; the first cells_used_ are in use
  std::size_t cells_used_ = 0;
  std::vector<std::size_t> order_;  ///< cells from port to starboard
  SkipCounts skipped_;
};

}  // namespace sonard::render
