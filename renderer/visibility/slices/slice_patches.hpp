// Visible pieces of a slice -> echo patches.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <glm/mat3x3.hpp>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/visibility/normal_pyramid.hpp"
#include "renderer/visibility/sampler.hpp"
#include "renderer/visibility/slices/piece_arrays.hpp"
#include "renderer/visibility/slices/piece_ends.hpp"

namespace sonard::render {

/// How the surface of one part answers.
struct PartSurface {
  std::shared_ptr<const TriangleMesh> mesh;
  std::shared_ptr<const NormalPyramid> normal_map;  ///< null: none, or switched off
  bool vertex_normals = false;                      ///< whether shading interpolates them
  float lambert_mu = 0.0F;
  float reflectance = 0.0F;
  glm::mat3 R_part_sonar{1.0F};  ///< for this ping
};

/// One-way elevation pattern as a function of t, tabled.
class ElevationPattern {
 public:
  /// @param tabled_if_flat a pattern that is 1 everywhere too (SkipRule::flat_elevation switched off)
  explicit ElevationPattern(const Aperture& aperture, bool tabled_if_flat = false);
  bool flat() const { return weight_.empty(); }
  float at(float t) const;

 private:
  float tan_limit_;
  std::vector<float> weight_;  ///< empty: 1 everywhere
};

/// One per thread; keeps its memory.
class SlicePatcher {
 public:
  struct Request {
    const Slice& slice;
    const std::vector<VisiblePiece>& pieces;
    const std::vector<PartSurface>& parts;
    const SurfaceModel& surface;
    const ElevationPattern& pattern;
    float tan_limit;  ///< of the fan's elevation
    /// Within a piece the echo is taken as even in range, or as rising in a straight line. Pieces are divided
    /// until that displaces it by no more than this many lines.
    float evenness;
    bool any_mapped;  ///< whether any of the parts has a normal map
    float line_m;
    float max_range_m;  ///< what is wholly beyond is left as it is
  };

  /// @param patches is appended to.
  void make(const Request& request, std::vector<EchoPatch>& patches);

 private:
  void lay_out(const Request& request);
  void measure(const Request& request);
  void find_tilts(const Request& request);
  bool divide_uneven(const Request& request);
  bool all_even(float allowed_m) const;
  int parts_of(const Request& request, std::size_t i) const;
  static bool is_mapped(const Request& request, const VisiblePiece& piece);
  void shade(const Request& request);

  /// Pieces after division, and what is known of each; arrays are as long as those of `seen_`.
  const std::vector<VisiblePiece>* pieces_ = nullptr;  ///< the request's, or whole_
  std::vector<VisiblePiece> whole_, divided_;
  PieceArrays seen_;
  PieceEnds ends_;
  std::vector<float> range_low_, range_mid_, range_high_, smear_low_, smear_high_, cosine_, solid_angle_;
  std::vector<float> plain_;        ///< 1 where the response is the cosine to the facet, else 0
  std::vector<float> range_tilt_;   ///< of the solid angle along the range, see EchoPatch; 0: not to be used
  std::vector<float> cosine_tilt_;  ///< of cosine_, the mean of a piece
  std::vector<float> cosine_mid_;   ///< in its middle
  std::vector<float> echo_tilt_;    ///< of both
  std::vector<float> displaced_;    ///< how far the echo may be from where it is taken to be, metres
  std::vector<float> response_;
};

}  // namespace sonard::render
