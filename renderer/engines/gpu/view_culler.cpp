// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/view_culler.hpp"

#include <osg/Camera>
#include <osg/FrameStamp>
#include <osgUtil/RenderBin>
#include <osgUtil/RenderLeaf>
#include <osgUtil/RenderStage>

#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

namespace {

/// Reversed depth without a far plane: depth = near / distance. The relative resolution of floats is then
/// even, and a small near distance costs no accuracy (docs/physics.md 4.2). For visibility only; ranges never
/// come from the depth buffer. Views lie on their side (ViewLayout): x of the eye is y of the screen.
osg::Matrixd projection_matrix(const SubView& view) {
  return osg::Matrixd(0, 1 / view.tan_half_width, 0, 0,   //
                      1 / view.tan_half_height, 0, 0, 0,  //
                      0, 0, 0, -1,                        //
                      0, 0, static_cast<double>(nearest_depth_m), 0);
}

void collect(const osgUtil::RenderBin& bin, CulledView& view) {
  for (const osgUtil::RenderLeaf* leaf : bin.getRenderLeafList()) {
    view.leaves.push_back({static_cast<MeshChunk*>(leaf->_drawable.get()),  // all drawables are MeshChunks
                           leaf->_parent->getStateSet(), leaf->_modelview});
    view.projection = leaf->_projection;
  }
  for (const auto& [number, inner] : bin.getRenderBinList()) {
    collect(*inner, view);
  }
}

}  // namespace

osg::Matrixd view_matrix(const SubView& view) {
  const osg::Matrixd turn = osg::Matrixd::rotate(-view.azimuth_rad, osg::Vec3d(0, 0, 1));
  // OSG multiplies row vectors: row i is the image of axis i.
  const osg::Matrixd axes(0, 0, -1, 0,  //
                          -1, 0, 0, 0,  //
                          0, 1, 0, 0,   //
                          0, 0, 0, 1);
  return turn * axes;
}

ViewCuller::ViewCuller(osg::State& state, osg::Node& scene) : scene_view_(new osgUtil::SceneView) {
  osgUtil::RenderBin::setDefaultRenderBinSortMode(osgUtil::RenderBin::SORT_FRONT_TO_BACK);
  scene_view_->setDefaults(osgUtil::SceneView::NO_SCENEVIEW_LIGHT);
  scene_view_->setState(&state);
  scene_view_->setSceneData(&scene);
  scene_view_->setFrameStamp(new osg::FrameStamp);
  scene_view_->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
  osg::Camera& camera = *scene_view_->getCamera();
  camera.setReferenceFrame(osg::Transform::ABSOLUTE_RF);
  camera.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
}

CulledView ViewCuller::cull(const SubView& view, bool bent) {
  osg::Camera& camera = *scene_view_->getCamera();
  camera.setViewport(0, 0, view.rows, view.columns);
  camera.setViewMatrix(view_matrix(view));
  camera.setProjectionMatrix(projection_matrix(view));
  // Only the sides cull: there is no far plane, and small objects have echoes too.
  const osg::CullSettings::CullingMode culling =
      bent ? osg::CullSettings::NO_CULLING : osg::CullSettings::VIEW_FRUSTUM_SIDES_CULLING;
  scene_view_->setCullingMode(culling);
  camera.setCullingMode(culling);
  scene_view_->cull();
  CulledView found;
  collect(*scene_view_->getRenderStage(), found);
  return found;
}

}  // namespace sonard::render
