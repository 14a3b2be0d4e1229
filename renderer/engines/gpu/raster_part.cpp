// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_part.hpp"

#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/surface/backscatter.hpp"

namespace sonard::render {

namespace {

Shading shading_of(const BodyPart& part) {
  if (part.normal_map && part.mesh->can_be_mapped()) {
    return Shading::normal_mapped;
  }
  return part.mesh->normals.empty() ? Shading::geometric_normal : Shading::vertex_normals;
}

}  // namespace

osg::Matrixd to_osg(const Pose& T_a_b) {
  const glm::dquat& q = T_a_b.orientation;
  return osg::Matrixd::rotate(osg::Quat(q.x, q.y, q.z, q.w)) *
         osg::Matrixd::translate(T_a_b.position_m.x, T_a_b.position_m.y, T_a_b.position_m.z);
}

bool same_surface(const BodyPart& a, const BodyPart& b) {
  return a.material == b.material && a.normal_map == b.normal_map && shading_of(a) == shading_of(b);
}

Surface make_surface(const BodyPart& part) {
  Surface surface{new osg::StateSet, shading_of(part), nullptr};
  osg::StateSet& state = *surface.state;
  if (surface.shading == Shading::normal_mapped) {
    surface.normal_map = std::make_unique<NormalMapTexture>(NormalPyramid(*part.normal_map));
    surface.normal_map->add_to(state);
  }
  state.addUniform(new osg::Uniform("reflectance", static_cast<float>(part.material.reflectance)));
  const Backscatter backscatter(part.material);
  state.addUniform(new osg::Uniform("lambert_mu", backscatter.lambert_mu));
  state.addUniform(new osg::Uniform("facet_strength", backscatter.facet_strength));
  state.addUniform(new osg::Uniform("slope_variance", backscatter.slope_variance));
  state.addUniform(new osg::Uniform("facets_least_cosine", backscatter.least_cosine));
  return surface;
}

osg::ref_ptr<osg::MatrixTransform> make_part(const BodyPart& part, const Surface& surface,
                                             const float* max_range_m) {
  osg::ref_ptr<osg::MatrixTransform> node = new osg::MatrixTransform(to_osg(part.T_body_part));
  node->setStateSet(surface.state);
  add_chunks(*part.mesh, max_range_m, *node);
  return node;
}

}  // namespace sonard::render
