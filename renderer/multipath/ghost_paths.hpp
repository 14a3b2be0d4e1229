// SPDX-License-Identifier: Apache-2.0
// Echoes by way of a mirror: a ray from the sonar is mirrored by a smooth surface and hits a rough one
// (docs/physics.md 2.11).
#pragma once

#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/multipath/path_fan.hpp"
#include "renderer/multipath/path_scene.hpp"
#include "renderer/pose.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Limits of the paths that are followed.
struct PathLimits {
  double wavelength_m = 0.0;
  double max_range_m = 0.0;
  double least_gain = 0.0;    ///< weaker mirrors are ignored
  bool meshes_mirror = true;  ///< false: only the water surface mirrors
};

/// A part of the echo and the beam that receives it. EchoPatch::echo does not yet include spreading and
/// absorption, like the direct echo.
struct BeamPatch {
  int beam;
  EchoPatch patch;
};

/// A possible corner of two or three mirrors, which reflect sound straight back: the image of the sonar in
/// them.
struct CornerCandidate {
  glm::dvec3 image_m{0.0};  ///< relative to the sonar, in world axes; the corner is half way to it
};

/// The mirror image of a point in the plane of a hit.
inline glm::dvec3 mirrored(const glm::dvec3& point_m, const PathHit& mirror) {
  return point_m - 2 * glm::dot(point_m - mirror.position_m, mirror.normal) * mirror.normal;
}

/// The direction of a leg after a mirror.
inline glm::dvec3 reflected(const glm::dvec3& direction, const glm::dvec3& normal) {
  return direction - 2 * glm::dot(direction, normal) * normal;
}

/// Follows rays over the whole fan. The fan is first divided into even cells. Cells whose path differs from a
/// neighbour's, at the edge of a flat mirror or of an object seen in it, are divided again. Results do not
/// depend on the number of threads or their order.
class GhostPaths {
 public:
  struct Result {
    std::vector<BeamPatch> patches;
    std::vector<CornerCandidate> corners;
  };

  explicit GhostPaths(WorkerPool& workers) : workers_(workers) {}

  /// @return the results of blocks of cells, from port to starboard; valid until the next call.
  const std::vector<Result>& follow(const PathScene& scene, const PathFan& fan, const Pose& T_world_sonar,
                                    const PathLimits& limits);

  /// Searches for corners with rays in the given cells alone.
  static Result search(const PathScene& scene, const PathFan& fan, const Pose& T_world_sonar,
                       const PathLimits& limits, const std::vector<FanCell>& cells);

 private:
  /// From the sonar by way of a mirror to a target.
  struct Path {
    int row = 0;
    PathHit mirror, target;
    double gain = 0.0;         ///< of the mirror
    bool target_seen = false;  ///< the straight line from the target to the sonar is free and in the fan
  };
  struct Ping;

  static std::uint64_t follow_one(const Ping& ping, const FanCell& cell, Path& path, Result& result);
  static void find_corners(const Ping& ping, const glm::dvec3& direction, const Path& path, Result& result);
  static void add_echoes(const Ping& ping, const FanCell& cell, const Path& path, Result& result);
  static std::uint64_t follow_on(const Ping& ping, const glm::dvec3& direction, Path& path, Result& result);
  static std::size_t index(const PathFan& fan, int column, int row) {
    return static_cast<std::size_t>(column) * static_cast<std::size_t>(fan.rows()) +
           static_cast<std::size_t>(row);
  }
  Result& result_of(const PathFan& fan, int column, int row);
  void follow_columns(const Ping& ping, int first_column);
  void refine(const Ping& ping, int column, int first_row);
  static void follow_parts(const Ping& ping, const FanCell& cell, int first_row, Result& result);
  bool differs_from_neighbours(const Ping& ping, int column, int row) const;

  WorkerPool& workers_;
  std::vector<std::uint64_t> keys_;       // follow_on() per cell, column after column
  std::vector<std::vector<Path>> paths_;  // per column, of cells with a target
  std::vector<Result> results_;           // per rows_per_block cells of a column
};

}  // namespace sonard::render
