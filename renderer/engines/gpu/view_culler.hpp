// SPDX-License-Identifier: Apache-2.0
// Culling of a view with OpenSceneGraph.
#pragma once

#include <vector>

#include <osg/Matrix>
#include <osg/Node>
#include <osg/State>
#include <osg/StateSet>
#include <osgUtil/SceneView>

#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::render {

/// Transform from the sonar frame (x forward, y port, z up) to the eye frame of a view (x starboard, y up,
/// -z forward).
osg::Matrixd view_matrix(const SubView& view);

/// The chunks that a view draws.
struct CulledView {
  struct Leaf {
    MeshChunk* chunk;
    const osg::StateSet* surface;  ///< see make_surface()
    osg::ref_ptr<osg::RefMatrix> body_to_eye;
  };
  osg::ref_ptr<osg::RefMatrix> projection;
  std::vector<Leaf> leaves;  ///< nearest first, so that hidden surfaces are not shaded
};

class ViewCuller {
 public:
  /// @param scene has MeshChunks below the nodes of make_part()
  ViewCuller(osg::State& state, osg::Node& scene);

  /// @param bent true if rays bend: then only chunks beyond the range are culled, because boxes do not bend
  CulledView cull(const SubView& view, bool bent);

 private:
  osg::ref_ptr<osgUtil::SceneView> scene_view_;
};

}  // namespace sonard::render
