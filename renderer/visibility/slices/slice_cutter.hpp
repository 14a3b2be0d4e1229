// Cuts the triangles of one beam with half planes of constant azimuth.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "renderer/visibility/slices/fan_triangles.hpp"

namespace sonard::render {

/// A slice: the half plane h > 0 at one azimuth, with horizontal distance h and height z as coordinates, and
/// the thin wedge around it that it stands for. Rays of the slice are told apart by the tangent of their
/// elevation, t = z / h; along any straight line of it 1 / h is affine in t.
struct Slice {
  double azimuth_rad = 0.0;
  float width_rad = 0.0F;  ///< of the wedge
};

/// What a slice cuts out of triangles: straight segments, in arrays because loops over them are vectorised.
struct Segments {
  int count = 0;
  std::vector<float> low, high;        ///< t at the two ends; low < high
  std::vector<float> w_at_0, w_slope;  ///< 1 / h = w_at_0 + w_slope * t
  /// dt / d azimuth of the ends, as the edges of the triangle run; what an edge moves within the wedge is
  /// limited to its own length.
  std::vector<float> low_drift, high_drift;
  std::vector<std::int32_t> triangle;  ///< index into the beam's triangles

  void reserve(std::size_t size);
  float w(int segment, float t) const {
    const auto s = static_cast<std::size_t>(segment);
    return w_at_0[s] + w_slope[s] * t;
  }
};

/// The triangles of one beam, ready to be cut at any azimuth inside it.
class SliceCutter {
 public:
  /// @param two_sided false: triangles seen from behind are left out.
  void load(std::span<const FanTriangle* const> triangles, bool two_sided);

  /// Segments with elevations between -tan_limit and tan_limit, in the order of the triangles. An edge shared
  /// by two triangles is cut at the same point, to the bit.
  void cut(const Slice& slice, float tan_limit, Segments& segments);

  /// Whether some triangle lies between the middle of a slice and the sides of its wedge, and is narrow and
  /// tall: the leg of a frame, a pole. Slices that miss such a thing miss all of it.
  bool misses_thin_triangle(const Slice& slice) const;

  const FanTriangle& triangle(int index) const { return *triangles_[static_cast<std::size_t>(index)]; }
  /// Unit normal in the sonar frame; its sign is that of the winding.
  const float* normal_x() const { return normal_x_.data(); }
  const float* normal_y() const { return normal_y_.data(); }
  const float* normal_z() const { return normal_z_.data(); }

 private:
  void load_normals();
  void drop_back_faces();
  void list_thin();
  void cut_all(float cosine, float sine, float width_rad, float tan_limit);
  void clip_behind(float cosine, float sine, float tan_limit, int i);

  std::vector<const FanTriangle*> triangles_;
  std::size_t padded_ = 0;
  std::vector<float> x_[3], y_[3], z_[3];
  std::vector<float> normal_x_, normal_y_, normal_z_;
  std::vector<const FanTriangle*> thin_;
  // One slice's segments, one per triangle, before those that do not exist are left out.
  enum Fate : std::int32_t { none, kept, partly_behind };
  std::vector<float> low_, high_, w_at_0_, w_slope_, low_drift_, high_drift_;
  std::vector<std::int32_t> fate_;
};

}  // namespace sonard::render
