// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_sampler.hpp"

#include <algorithm>
#include <map>
#include <string>

#include <osg/ClipControl>
#include <osg/Depth>
#include <osg/FrameBufferObject>
#include <osg/MatrixTransform>
#include <osgUtil/CullVisitor>
#include <osgUtil/RenderLeaf>
#include <osgUtil/RenderStage>
#include <osgUtil/SceneView>

#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/engines/gpu/raster_surface.hpp"
#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/errors.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/refraction.hpp"

namespace sonard::render {

namespace {

osg::Matrixd to_osg(const Pose& T_a_b) {
  const glm::dquat& q = T_a_b.orientation;
  return osg::Matrixd::rotate(osg::Quat(q.x, q.y, q.z, q.w)) *
         osg::Matrixd::translate(T_a_b.position_m.x, T_a_b.position_m.y, T_a_b.position_m.z);
}

/// Transform from the sonar frame (x forward, y port, z up) to the eye frame of a view (x starboard, y up,
/// -z forward).
osg::Matrixd view_matrix(const SubView& view) {
  const osg::Matrixd turn = osg::Matrixd::rotate(-view.azimuth_rad, osg::Vec3d(0, 0, 1));
  // OSG multiplies row vectors: row i is the image of axis i.
  const osg::Matrixd axes(0, 0, -1, 0,  //
                          -1, 0, 0, 0,  //
                          0, 1, 0, 0,   //
                          0, 0, 0, 1);
  return turn * axes;
}

/// Reversed depth without a far plane: depth = near / distance. The relative resolution of floats is then
/// even, and a small near distance costs no accuracy (docs/physics.md 4.2). For visibility only; ranges never
/// come from the depth buffer.
osg::Matrixd projection_matrix(const SubView& view) {
  return osg::Matrixd(1 / view.tan_half_width, 0, 0, 0,   //
                      0, 1 / view.tan_half_height, 0, 0,  //
                      0, 0, 0, -1,                        //
                      0, 0, static_cast<double>(nearest_depth_m), 0);
}

/// Culls chunks that lie wholly beyond the range of the sonar.
class RangeCull final : public osg::Drawable::CullCallback {
 public:
  float max_range_m = 0.0F;

  bool cull(osg::NodeVisitor* visitor, osg::Drawable* drawable, osg::RenderInfo* /*info*/) const override {
    const osg::Vec3 eye = static_cast<osgUtil::CullVisitor*>(visitor)->getEyeLocal();
    const osg::BoundingBox& box = drawable->getBoundingBox();
    const osg::Vec3 nearest(std::clamp(eye.x(), box.xMin(), box.xMax()),
                            std::clamp(eye.y(), box.yMin(), box.yMax()),
                            std::clamp(eye.z(), box.zMin(), box.zMax()));
    return (nearest - eye).length() > max_range_m;
  }
};

/// Chunks and normal maps with their bytes.
using Items = std::map<osg::ref_ptr<const osg::Object>, std::uint64_t>;

std::uint64_t bytes_of(const Items& items) {
  std::uint64_t bytes = 0;
  for (const auto& [item, item_bytes] : items) {
    bytes += item_bytes;
  }
  return bytes;
}

/// Adds what a bin draws.
void collect(const osgUtil::RenderBin& bin, Items& drawn) {
  for (const osgUtil::RenderLeaf* leaf : bin.getRenderLeafList()) {
    const auto* chunk = static_cast<const MeshChunk*>(leaf->_drawable.get());  // all drawables are MeshChunks
    drawn[chunk] = chunk->bytes();
    if (const osg::Texture2D* map = normal_map_of(*leaf->_parent->getStateSet())) {
      drawn[map] = map->getImage()->getTotalSizeInBytes();
    }
  }
  for (const auto& [number, inner] : bin.getRenderBinList()) {
    collect(*inner, drawn);
  }
}

}  // namespace

struct RasterSampler::Impl {
  struct Part {
    std::shared_ptr<const TriangleMesh> mesh;  // whose chunks are drawn
    osg::ref_ptr<osg::MatrixTransform> node;   // T_sonar_part of the current ping, and the surface
    Shading shading = Shading::geometric_normal;
  };

  EglContext& context;
  osg::State& state;
  const World& world;
  const std::uint64_t bound_bytes;
  osg::ref_ptr<osg::Group> scene = new osg::Group;
  osg::ref_ptr<osgUtil::SceneView> scene_view = new osgUtil::SceneView;
  osg::ref_ptr<RangeCull> range_cull = new RangeCull;
  std::vector<Part> parts;                                     // of all bodies
  std::map<std::string, osg::ref_ptr<osg::Program>> programs;  // by surface_shader_head()
  MeshCache<osg::ref_ptr<osg::Group>> replacements;            // chunks of meshes that replaced others
  Items held;                                                  // in video memory
  std::uint64_t bytes_uploaded = 0;
  int target_columns = 0, target_rows = 0;
  std::vector<std::vector<SurfaceSample>> samples;  // of each view

  Impl(EglContext& on, const World& of, std::uint64_t bound)
      : context(on), state(*on.getState()), world(of), bound_bytes(bound) {
    set_up_view();
    program(Shading::geometric_normal, {}, false);  // fails here if OpenGL cannot build it
    const BodyPart* last = nullptr;  // tiles of a terrain follow each other and share the surface
    RasterSurface surface;
    for (const Body& body : world.bodies) {
      for (const BodyPart& part : body.parts) {
        surface = last != nullptr && same_surface(*last, part) ? surface : make_raster_surface(part);
        last = &part;
        parts.push_back({part.mesh, new osg::MatrixTransform, surface.shading});
        parts.back().node->setStateSet(surface.state);
        parts.back().node->addChild(make_chunks(*part.mesh, range_cull));
        scene->addChild(parts.back().node);
      }
    }
  }

  void set_up_view() {
    scene_view->setDefaults(osgUtil::SceneView::NO_SCENEVIEW_LIGHT);
    scene_view->setState(&state);
    scene_view->setSceneData(scene);
    scene_view->setFrameStamp(new osg::FrameStamp);
    scene_view->setActiveUniforms(0);
    // Nearest first, so that hidden surfaces are not shaded.
    scene_view->getRenderStage()->setSortMode(osgUtil::RenderBin::SORT_FRONT_TO_BACK);
    scene_view->getRenderStage()->setDisableFboAfterRender(false);
    osg::Camera& camera = *scene_view->getCamera();
    camera.setReferenceFrame(osg::Transform::ABSOLUTE_RF);
    camera.setClearColor({0, 0, 0, 0});
    camera.setClearDepth(0);
    camera.setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    scene_view->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
    osg::ref_ptr<osg::StateSet> all = new osg::StateSet;
    all->setAttributeAndModes(
        new osg::ClipControl(osg::ClipControl::LOWER_LEFT, osg::ClipControl::ZERO_TO_ONE));
    all->setAttributeAndModes(new osg::Depth(osg::Depth::GREATER, 0.0, 1.0));
    scene_view->setGlobalStateSet(all);
  }

  /// The program of a kind of surface, built on first use.
  osg::ref_ptr<osg::Program> program(Shading shading, const SurfaceModel& surface, bool bent) {
    const std::string head = surface_shader_head(shading, surface, bent);
    osg::ref_ptr<osg::Program>& known = programs[head];
    if (!known) {
      known = context.build_program({new osg::Shader(osg::Shader::VERTEX, head + shaders::surface_vert),
                                     new osg::Shader(osg::Shader::FRAGMENT, head + shaders::surface_frag)},
                                    "the surface shader");
    }
    return known;
  }

  osg::Uniform& uniform(const std::string& name, osg::Uniform::Type type) const {
    return *scene_view->getGlobalStateSet()->getOrCreateUniform(name, type);
  }

  void set_surface(const SurfaceModel& surface, bool bent) {
    for (const Part& part : parts) {
      part.node->getStateSet()->setAttributeAndModes(program(part.shading, surface, bent));
    }
    scene_view->getGlobalStateSet()->setMode(
        GL_CULL_FACE, surface.two_sided ? osg::StateAttribute::OFF : osg::StateAttribute::ON);
    uniform("sigmoid", osg::Uniform::FLOAT_VEC2)
        .set(
            osg::Vec2(static_cast<float>(surface.sigmoid_slope), static_cast<float>(surface.sigmoid_centre)));
    uniform("attenuation_per_m", osg::Uniform::FLOAT).set(static_cast<float>(surface.attenuation_per_m));
    // Boxes do not bend. Otherwise the sides cull: there is no far plane, and small objects have echoes too.
    const osg::CullSettings::CullingMode culling =
        bent ? osg::CullSettings::NO_CULLING : osg::CullSettings::VIEW_FRUSTUM_SIDES_CULLING;
    scene_view->setCullingMode(culling);
    scene_view->getCamera()->setCullingMode(culling);
  }

  /// Moves all parts to their places in the frame of the sonar, and replaces meshes that have changed.
  void place(const Pose& T_world_sonar) {
    auto placed = parts.begin();
    for (const Body& body : world.bodies) {
      const osg::Matrixd T_sonar_body = to_osg(relative(T_world_sonar, body.T_world_body));
      for (const BodyPart& part : body.parts) {
        placed->node->setMatrix(to_osg(part.T_body_part) * T_sonar_body);
        if (placed->mesh != part.mesh) {
          placed->mesh = part.mesh;
          placed->node->setChild(0, chunks_of(part.mesh));
        }
        ++placed;
      }
    }
  }

  osg::ref_ptr<osg::Group> chunks_of(const std::shared_ptr<const TriangleMesh>& replacement) {
    if (const auto* known = replacements.find(replacement.get())) {
      return *known;
    }
    const osg::ref_ptr<osg::Group> chunks = make_chunks(*replacement, range_cull);
    replacements.keep(replacement, chunks);
    return chunks;
  }

  /// Makes room for what a view draws, which OpenSceneGraph uploads when it draws it. Items that are in no
  /// mesh any more are released, and all others that the view does not draw if they leave too little room.
  void hold(const Items& drawn) {
    check_video_memory(bytes_of(drawn), bound_bytes);
    for (const auto& [item, bytes] : drawn) {
      bytes_uploaded += held.insert({item, bytes}).second ? bytes : 0;
    }
    const bool is_full = bytes_of(held) > bound_bytes;
    const std::size_t released = std::erase_if(held, [&](const auto& item) {
      const bool goes = !drawn.contains(item.first) && (is_full || item.first->referenceCount() == 1);
      if (goes) {
        item.first->releaseGLObjects(&state);
      }
      return goes;
    });
    if (released > 0) {
      osg::flushAllDeletedGLObjects(state.getContextID());  // else OpenSceneGraph keeps them for reuse
    }
  }

  /// Makes textures of the size of a view, if they have another one.
  void hold_target(const SubView& view) {
    if (view.columns == target_columns && view.rows == target_rows) {
      return;
    }
    GLint most_px = 0;
    glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE_EXT, &most_px);
    if (view.columns > most_px || view.rows > most_px) {
      throw RequestError("sampling: a view exceeds the GL limit of " + std::to_string(most_px) + " pixels");
    }
    target_columns = view.columns;
    target_rows = view.rows;
    osg::ref_ptr<osg::FrameBufferObject> target = new osg::FrameBufferObject;
    target->setAttachment(osg::Camera::COLOR_BUFFER0, osg::FrameBufferAttachment(new osg::RenderBuffer(
                                                          view.columns, view.rows, GL_RGBA32F_ARB)));
    target->setAttachment(osg::Camera::DEPTH_BUFFER, osg::FrameBufferAttachment(new osg::RenderBuffer(
                                                         view.columns, view.rows, GL_DEPTH_COMPONENT32F)));
    scene_view->getRenderStage()->setFrameBufferObject(target);
    osg::flushAllDeletedGLObjects(state.getContextID());
  }

  void draw(const SubView& view, const Refraction& bend) {
    hold_target(view);
    const osg::Matrixd to_eye = view_matrix(view);
    scene_view->getCamera()->setViewport(0, 0, view.columns, view.rows);
    scene_view->getCamera()->setViewMatrix(to_eye);
    scene_view->getCamera()->setProjectionMatrix(projection_matrix(view));
    uniform("tan_half", osg::Uniform::FLOAT_VEC2)
        .set(osg::Vec2(static_cast<float>(view.tan_half_width), static_cast<float>(view.tan_half_height)));
    uniform("pixel", osg::Uniform::FLOAT_VEC2)
        .set(osg::Vec2(static_cast<float>(view.pixel_width()), static_cast<float>(view.pixel_height())));
    const osg::Vec3 up = osg::Matrixd::transform3x3(osg::Vec3(bend.up.x, bend.up.y, bend.up.z), to_eye);
    uniform("refraction", osg::Uniform::FLOAT_VEC4).set(osg::Vec4(up, bend.per_m));
    scene_view->cull();
    Items drawn;
    collect(*scene_view->getRenderStage(), drawn);
    hold(drawn);
    scene_view->draw();
    check_upload(bytes_of(held));
  }

  /// Waits for the drawing to end, and reads the samples of the view.
  void read(const SubView& view, std::vector<SurfaceSample>& into) const {
    static_assert(sizeof(SurfaceSample) == 4 * sizeof(float), "must match one RGBA32F pixel");
    into.resize(static_cast<std::size_t>(view.columns) * static_cast<std::size_t>(view.rows));
    glReadPixels(0, 0, view.columns, view.rows, GL_RGBA, GL_FLOAT, into.data());
    check_gl_errors("drawing the scene");
  }
};

RasterSampler::RasterSampler(EglContext& context, const World& world, std::uint64_t bound_bytes)
    : impl_(std::make_unique<Impl>(context, world, bound_bytes)) {}
RasterSampler::~RasterSampler() = default;

std::vector<const SurfaceSample*> RasterSampler::sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                                        const SurfaceModel& surface, float bend_per_m,
                                                        double max_range_m) {
  const Refraction bend{glm::vec3(glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1)),
                        bend_per_m};
  impl_->place(T_world_sonar);
  impl_->set_surface(surface, !bend.straight());
  impl_->range_cull->max_range_m = static_cast<float>(max_range_m);
  impl_->samples.resize(std::max(impl_->samples.size(), grid.views.size()));
  std::vector<const SurfaceSample*> samples;
  for (std::size_t v = 0; v < grid.views.size(); ++v) {
    impl_->draw(grid.views[v], bend);
    impl_->read(grid.views[v], impl_->samples[v]);
    samples.push_back(impl_->samples[v].data());
  }
  impl_->context.check();
  return samples;
}

std::uint64_t RasterSampler::bytes() const {
  return bytes_of(impl_->held);
}

std::uint64_t RasterSampler::bytes_uploaded() const {
  return impl_->bytes_uploaded;
}

}  // namespace sonard::render
