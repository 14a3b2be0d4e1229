// SPDX-License-Identifier: Apache-2.0
// Cuts the triangles of one beam with half planes of constant azimuth.
#pragma once

#include <bitset>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/slices/slice_math.hpp"

namespace sonard::render {

/// A slice (renderer/engines/slices/cut.glsl), and the thin wedge around it that it represents.
struct Slice {
  double azimuth_rad = 0.0;
  float width_rad = 0.0F;            ///< of the wedge
  float cosine = 1.0F, sine = 0.0F;  ///< of the azimuth

  Slice() = default;
  Slice(double azimuth, float width)
      : azimuth_rad(azimuth),
        width_rad(width),
        cosine(static_cast<float>(std::cos(azimuth))),
        sine(static_cast<float>(std::sin(azimuth))) {}
};

using slices::side_probes;
using ProbeSet = std::bitset<side_probes>;

/// An edge along a slice at which a surface ends or turns sharply: the end of a wall, the side of a post, the
/// corner of a room.
struct UprightEdge {
  double azimuth_rad = 0.0;
  ProbeSet probes;  ///< at which the surface ends or turns
};

/// Motion of a segment's end beside the slice, along the edge on which it lies.
struct EdgeRun {
  float slope = 0.0F;  ///< dt / d azimuth
  float reach = 0.0F;  ///< length of the edge in t: the largest move within a wedge
};

/// The straight segments that a slice cuts out of triangles, in arrays as long as the list of triangles, for
/// vectorised loops. Only segments in `kept` are valid.
struct Segments {
  std::vector<std::int32_t> kept;
  std::vector<float> low, high;                                     ///< t at the two ends; low < high
  std::vector<float> w_at_0, w_slope;                               ///< 1 / h = w_at_0 + w_slope * t
  std::vector<float> low_slope, high_slope, low_reach, high_reach;  ///< see EdgeRun

  EdgeRun low_run(std::size_t segment) const { return {low_slope[segment], low_reach[segment]}; }
  EdgeRun high_run(std::size_t segment) const { return {high_slope[segment], high_reach[segment]}; }
  float w(int segment, float t) const {
    const auto s = static_cast<std::size_t>(segment);
    return w_at_0[s] + w_slope[s] * t;
  }
};

/// The triangles of one beam, ready to be cut at any azimuth inside it.
class SliceCutter {
 public:
  /// @param low_rad, high_rad azimuths between which it will be cut; triangles elsewhere are left out
  /// @param two_sided false: triangles seen from behind are left out
  void load(std::span<const ListedTriangle> triangles, double low_rad, double high_rad, const Fan& fan,
            bool two_sided);

  /// Keeps the segments that reach between -tan_limit and tan_limit, in the order of the triangles. An edge
  /// shared by two triangles is cut at the same point, to the bit.
  void cut(const Slice& slice, float tan_limit, Segments& segments);

  /// Height of the tallest thin thing (the leg of a frame, a pole, a stone) that reaches into the wedge of a
  /// slice but not to its middle, so that the slice misses it; in t. At least slices::least_missed if there
  /// is one, or if a low thing (a cable) ends well inside the wedge; 0 if nothing is missed.
  float missed_height(const Slice& slice) const;

  /// Finds the upright edges and ends of low things well inside the wedge, from port to starboard; the
  /// highest ones if there are many.
  void find_upright_edges(const Slice& slice, std::vector<UprightEdge>& edges) const;

  const FanTriangle& triangle(int index) const { return *triangles_[static_cast<std::size_t>(index)]; }
  std::uint32_t part(int index) const { return part_[static_cast<std::size_t>(index)]; }
  /// Unit normal in the sonar frame, with the sign of the winding.
  const float* normal_x() const { return normal_x_.data(); }
  const float* normal_y() const { return normal_y_.data(); }
  const float* normal_z() const { return normal_z_.data(); }

 private:
  enum class Kind : std::uint8_t { thin, small, low };
  /// One triangle, or several of one kind and part that touch in azimuth.
  struct ThinThing {
    Kind kind;
    std::uint32_t part;
    float low_azimuth_rad, high_azimuth_rad;
    float low_t, high_t;  ///< of the first triangle
  };

  void load_normals();
  void drop_back_faces();
  void list_thin();
  float height_within(const Slice& slice, const ThinThing& thing) const;
  void list_upright_edges(double low_rad, double high_rad, const Fan& fan);
  void add_edge_parts(const FanTriangle& triangle, double low_rad, double high_rad, const Fan& fan);
  ProbeSet probes_of_edge(std::size_t begin, std::size_t end) const;
  void cut_all(const Slice& slice, float tan_limit, Segments& segments);
  void clip_behind(const Slice& slice, float tan_limit, std::size_t i, Segments& segments);

  std::vector<const FanTriangle*> triangles_;
  std::size_t padded_ = 0;
  std::vector<float> x_[3], y_[3], z_[3];
  std::vector<float> normal_x_, normal_y_, normal_z_;
  std::vector<std::uint32_t> part_;
  std::vector<ThinThing> thin_triangles_;  ///< one each, by kind, part and azimuth
  std::vector<ThinThing> thin_;            ///< thin or small
  std::vector<float> low_ends_;            ///< azimuths at which low things end
  /// An upright edge of one triangle.
  struct EdgePart {
    double azimuth_rad;
    std::int32_t first_probe, last_probe;  ///< probes first <= i < last
    /// 1 if the triangle lies to port of the edge, else -1. If a surface continues on the other side, the two
    /// cancel; if it ends or folds back, they do not.
    std::int32_t side;
    float facing_rad;  ///< azimuth of the triangle's normal; cancels too if the surface continues evenly
  };
  std::vector<EdgePart> edge_parts_;  ///< by rising azimuth
  std::vector<std::int32_t> fate_;    ///< per triangle, in the current slice: slices::CutTriangle
};

}  // namespace sonard::render
