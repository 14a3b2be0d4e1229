// What one pixel of a grid sees.
#pragma once

namespace sonard::render {

/// What is seen along the ray of one pixel. With q the un-normalised ray of SubView, range_dx and range_dy
/// are the signed derivatives of the range along the tangents x and y on the plane of the surface hit
/// (docs/physics.md 2.3, equation 2); they use the geometric normal, never the shading normal.
struct SurfaceSample {
  float range_m = 0.0F;   ///< slant range to the first surface; 0: nothing seen
  float response = 0.0F;  ///< echo per solid angle at unit range; see SurfaceModel
  float range_dx = 0.0F;  ///< metres per unit tangent
  float range_dy = 0.0F;

  bool operator==(const SurfaceSample&) const = default;
};

}  // namespace sonard::render
