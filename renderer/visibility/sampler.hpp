// The face every visibility method shows to the rest of the renderer.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/visibility/backscatter.hpp"
#include "renderer/visibility/sample_grid.hpp"

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

/// How a surface turns incidence into `SurfaceSample::response`.
struct SurfaceModel {
  Model model = Model::physical;
  Facets facets = Facets::none;  ///< only with `physical`
  /// `physical`: response = s_b / cos phi; Lambert's mu cos phi, and what Backscatter says of facets.
  /// `paper`: response = sigmoid(min(1, rho |cos phi| exp(-2 a r))).
  double sigmoid_slope = 18.0;
  double sigmoid_centre = 2.0 / 3.0;
  double attenuation_per_m = 0.0;
  bool two_sided = true;
};

/// SurfaceSample::response of mode `paper`, for a surface of this reflectance seen under cos phi = `cosine`.
/// What is not a number stays so.
inline float paper_response(const SurfaceModel& model, float reflectance, float cosine, float range_m) {
  float echo = reflectance * cosine;
  if (model.attenuation_per_m != 0.0) {
    echo *= std::exp(static_cast<float>(-2.0 * model.attenuation_per_m) * range_m);
  }
  const auto slope = static_cast<float>(model.sigmoid_slope);
  const auto centre = static_cast<float>(model.sigmoid_centre);
  return 1.0F / (1.0F + std::exp(slope * (centre - (echo > 1.0F ? 1.0F : echo))));
}

/// Finds the first surface along every pixel of a grid. One thread uses a sampler.
/// To add a method, implement this and construct it in SonarRenderer.
class Sampler {
 public:
  Sampler() = default;
  virtual ~Sampler() = default;
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;

  /// The samples of view i, row after row as SubView orders them. They stay valid until the next call.
  /// Surfaces beyond `max_range_m` may be reported or not.
  /// @throws RendererError when the method itself fails.
  virtual std::vector<const SurfaceSample*> sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                                   const SurfaceModel& surface, double max_range_m) = 0;

  /// @param body in the order of the world, and in it.
  virtual void set_body_pose(std::size_t body, const Pose& T_world_body) = 0;

  /// Gives parts other meshes, with the attributes of those they had. Not for every ping: trees are built.
  /// @throws RendererError when the method itself fails.
  virtual void set_part_meshes(std::span<const PartMesh> changes) = 0;

  /// From the next call on level rays sink by `bend_per_m` * x^2 over the horizontal distance x (RayBend); 0,
  /// as at the beginning: they are straight.
  virtual void set_ray_bend(double bend_per_m) = 0;

  /// The method and what it runs on, for logs: "raster, vendor / renderer / version".
  virtual const std::string& description() const = 0;
};

}  // namespace sonard::render
