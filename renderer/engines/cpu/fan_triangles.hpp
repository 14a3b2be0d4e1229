// SPDX-License-Identifier: Apache-2.0
// The triangles of the world that may lie in each beam.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "renderer/engines/slices/fan.hpp"
#include "renderer/engines/slices/mesh_clusters.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// A triangle that may be in the fan, in the sonar frame.
struct FanTriangle {
  float x[3], y[3], z[3];
  std::uint32_t part = 0;           ///< index of the PlacedPart
  std::uint32_t mesh_triangle = 0;  ///< its number in the part's mesh
  std::uint32_t number = 0;         ///< among the triangles of the ping, from 0
  bool thin = false;                ///< much taller than wide, as seen from the sonar: the leg of a frame
  /// Part of an object that may lie between two slices: a stone, a plate.
  bool small = false;
  bool low = false;      ///< of a part that may lie between two probes of SliceSides: a cable
  bool upright = false;  ///< has an edge that runs along slices, Fan::upright_rad()
  /// Azimuths of its sides; -pi and pi if it may contain the sonar's vertical axis.
  float low_azimuth_rad = 0.0F, high_azimuth_rad = 0.0F;

  glm::vec3 corner(std::size_t k) const { return {x[k], y[k], z[k]}; }
  /// Normal by the winding of the triangle; its length is twice the area.
  glm::vec3 across() const { return glm::cross(corner(1) - corner(0), corner(2) - corner(0)); }
};

/// Entry of a beam's list, with a copy of the azimuths, so that triangles beside a slice are skipped without
/// a look-up.
struct ListedTriangle {
  const FanTriangle* triangle;
  float low_azimuth_rad, high_azimuth_rad;
};

/// Culls clusters against fan and range, transforms the rest, and culls triangles. The remaining triangles
/// are listed for every beam that their azimuths touch. A superfluous triangle costs time but makes no error.
class FanTriangles {
 public:
  static constexpr int share_count =
      32;  ///< jobs; fixed, so that the order of triangles depends on no thread

  /// Fills the lists, which are the same for any number of threads.
  /// @param skip culled_clusters: clusters out of the fan are dropped as a whole; hidden_faces: so are
  /// triangles
  ///   of which only the inner side of a Shell is turned to the sonar
  void find(const std::vector<PlacedPart>& parts, const Fan& fan, const Refraction& bend, WorkerPool& workers,
            const SkipSwitches& skip);

  /// Triangles of a beam in the order of the world; of surfaces in the same place, the first is visible.
  std::span<const ListedTriangle> of_beam(int beam) const {
    const auto b = static_cast<std::size_t>(beam);
    return {listed_.data() + first_of_beam_[b], first_of_beam_[b + 1] - first_of_beam_[b]};
  }
  std::size_t count() const { return count_; }  ///< of triangles
  std::span<const FanTriangle> of_share(int share) const {
    return shares_[static_cast<std::size_t>(share)].triangles;
  }
  std::uint64_t clusters_culled() const;
  std::uint64_t faces_hidden() const;  ///< triangles, of those that are not in culled clusters

 private:
  /// The triangles that one job finds in its range of clusters.
  struct Share {
    std::vector<FanTriangle> triangles;
    std::vector<Fan::BeamRange> beams;    ///< of each triangle
    std::vector<std::uint32_t> per_beam;  ///< number of triangles; later the place of the next one in listed_
    std::vector<std::uint8_t> tall;       ///< per part: 1 if a cluster in the fan is not low
    std::uint64_t culled = 0, hidden = 0;
    std::size_t first = 0;  ///< number of its first triangle

    void add(const FanTriangle& triangle, Fan::BeamRange range);
  };

  void find_hiding_shells(const std::vector<PlacedPart>& parts, bool may_hide);
  void collect(const std::vector<PlacedPart>& parts, const Fan& fan, const Refraction& bend,
               std::size_t begin, std::size_t end, Share& share) const;
  static void add(const FanTriangle& triangle, const std::array<float, 3>& azimuth, const Fan& fan,
                  Share& share);
  void find_low_parts(std::size_t parts);
  void make_room_for_lists(std::size_t beams);
  void list(Share& share);

  std::vector<std::uint32_t> part_starts_;  ///< first cluster of each part, numbered over all parts
  std::vector<Share> shares_;
  std::vector<ListedTriangle> listed_;
  std::vector<std::size_t> first_of_beam_;
  std::vector<std::uint8_t> is_low_;  ///< per part
  std::size_t cluster_count_ = 0;
  std::size_t count_ = 0;
  bool cull_ = true;
  /// Shell::outwards of each shell of each part whose inner side is hidden now; 0 if it may be seen.
  std::vector<std::vector<float>> hiding_;
};

}  // namespace sonard::render
