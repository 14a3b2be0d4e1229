// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_sampler.hpp"

#include <algorithm>
#include <cstdint>
#include <list>
#include <map>
#include <unordered_map>

#include <osg/Camera>
#include <osg/ClipControl>
#include <osg/CullFace>
#include <osg/Depth>
#include <osg/MatrixTransform>
#include <osg/Program>
#include <osg/Texture2D>
#include <osgUtil/RenderBin>
#include <osgUtil/SceneView>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/engines/gpu/raster_part.hpp"
#include "renderer/engines/gpu/surface_shader.hpp"
#include "renderer/errors.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

/// Sonar frame (x forward, y port, z up) to the eye frame of a view (x starboard, y up, -z forward).
osg::Matrixd view_matrix(const SubView& view) {
  const osg::Matrixd turn = osg::Matrixd::rotate(-view.azimuth_rad, osg::Vec3d(0, 0, 1));
  // OSG multiplies row vectors: row i is the image of axis i.
  const osg::Matrixd axes(0, 0, -1, 0,  //
                          -1, 0, 0, 0,  //
                          0, 1, 0, 0,   //
                          0, 0, 0, 1);
  return turn * axes;
}

/// Reversed depth without a far plane: depth = near / distance, so that float resolution is even in relative
/// terms and loses nothing by a small near distance (docs/physics.md 4.2). Visibility only; ranges never come
/// from the depth buffer.
osg::Matrixd projection_matrix(const SubView& view) {
  return osg::Matrixd(1 / view.tan_half_width, 0, 0, 0,   //
                      0, 1 / view.tan_half_height, 0, 0,  //
                      0, 0, 0, -1,                        //
                      0, 0, static_cast<double>(nearest_depth_m), 0);
}

/// A camera that draws views of one size into a float texture, and the copy that is read back.
struct ViewTarget {
  int columns = 0, rows = 0;
  osg::ref_ptr<osgUtil::SceneView> scene_view;
  osg::ref_ptr<osg::Texture2D> samples_texture, depth_texture;
  osg::ref_ptr<osg::Uniform> tan_half;
  osg::ref_ptr<osg::Uniform> refraction;
  std::vector<SurfaceSample> samples;
  std::uint64_t used = 0;  ///< number of the call that used it last

  double pixels() const { return 1.0 * columns * rows; }
};

osg::ref_ptr<osg::Texture2D> make_texture(int columns, int rows, GLint internal_format, GLenum format) {
  osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D;
  texture->setTextureSize(columns, rows);
  texture->setInternalFormat(internal_format);
  texture->setSourceFormat(format);
  texture->setSourceType(GL_FLOAT);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
  texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
  return texture;
}

ViewTarget make_target(int columns, int rows, osg::Node* scene, osg::State* state) {
  ViewTarget target;
  target.columns = columns;
  target.rows = rows;
  target.samples_texture = make_texture(columns, rows, GL_RGBA32F_ARB, GL_RGBA);
  target.depth_texture = make_texture(columns, rows, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);

  target.scene_view = new osgUtil::SceneView;
  target.scene_view->setDefaults(osgUtil::SceneView::NO_SCENEVIEW_LIGHT);
  target.scene_view->setState(state);
  target.scene_view->setSceneData(scene);
  target.scene_view->setFrameStamp(new osg::FrameStamp);
  osg::Camera* camera = target.scene_view->getCamera();
  camera->setViewport(0, 0, columns, rows);
  camera->setClearColor(osg::Vec4(0, 0, 0, 0));
  camera->setClearDepth(0.0);
  camera->setRenderTargetImplementation(osg::Camera::FRAME_BUFFER_OBJECT);
  camera->setDrawBuffer(GL_COLOR_ATTACHMENT0_EXT);
  camera->setReadBuffer(GL_COLOR_ATTACHMENT0_EXT);
  camera->attach(osg::Camera::COLOR_BUFFER0, target.samples_texture);
  camera->attach(osg::Camera::DEPTH_BUFFER, target.depth_texture);
  camera->setReferenceFrame(osg::Transform::ABSOLUTE_RF);
  osg::StateSet* state_set = target.scene_view->getGlobalStateSet();
  target.tan_half = new osg::Uniform("tan_half", osg::Vec2());
  state_set->addUniform(target.tan_half);
  target.refraction = new osg::Uniform("refraction", osg::Vec4());
  state_set->addUniform(target.refraction);
  state_set->addUniform(
      new osg::Uniform("pixels", osg::Vec2(static_cast<float>(columns), static_cast<float>(rows))));
  target.scene_view->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
  camera->setComputeNearFarMode(osg::CullSettings::DO_NOT_COMPUTE_NEAR_FAR);
  return target;
}

/// @param bend in the sonar frame
void aim(const ViewTarget& target, const SubView& view, const Refraction& bend) {
  target.scene_view->getCamera()->setViewMatrix(view_matrix(view));
  target.scene_view->getCamera()->setProjectionMatrix(projection_matrix(view));
  target.tan_half->set(
      osg::Vec2(static_cast<float>(view.tan_half_width), static_cast<float>(view.tan_half_height)));
  const osg::Vec3 up =
      osg::Matrixd::transform3x3(osg::Vec3(bend.up.x, bend.up.y, bend.up.z), view_matrix(view));
  target.refraction->set(osg::Vec4(up, bend.per_m));
  // Only the sides cull: there is no far plane, and small features are echoes too. Boxes are not bent, so
  // with refraction none of them is dropped; their ranges stay what they are.
  const osg::CullSettings::CullingMode culling =
      bend.straight() ? osg::CullSettings::VIEW_FRUSTUM_SIDES_CULLING : osg::CullSettings::NO_CULLING;
  target.scene_view->setCullingMode(culling);
  target.scene_view->getCamera()->setCullingMode(culling);
}

/// What some views draw, culled and sorted front to back.
struct DrawList {
  std::vector<VideoMemory::Item*> items;
  std::uint64_t draw_calls = 0, triangles = 0;
};

/// Adds what a view draws.
/// @param normal_maps by the state that asks for them.
void collect(const osgUtil::RenderBin& bin,
             const std::unordered_map<const osg::StateSet*, NormalMapTexture*>& normal_maps, DrawList& list) {
  const osgUtil::StateGraph* last = nullptr;
  for (const osgUtil::RenderLeaf* leaf : bin.getRenderLeafList()) {
    auto& chunk = static_cast<MeshChunk&>(*leaf->_drawable);  // nothing else is drawn
    list.items.push_back(&chunk);
    ++list.draw_calls;
    list.triangles += chunk.triangles();
    for (const osgUtil::StateGraph* state = leaf->_parent; state != nullptr && leaf->_parent != last;
         state = state->_parent) {
      if (const auto map = normal_maps.find(state->getStateSet()); map != normal_maps.end()) {
        list.items.push_back(map->second);
      }
    }
    last = leaf->_parent;
  }
  for (const auto& [number, inner] : bin.getRenderBinList()) {
    collect(*inner, normal_maps, list);
  }
}

// Making a target takes as long as drawing into it, so those of earlier calls are kept: so many pixels in all
// (36 bytes each), and as many targets.
constexpr double most_kept_pixels = 0x1p25;
constexpr std::size_t most_kept_targets = 1024;

}  // namespace

struct RasterSampler::Impl {
  struct BodyNode {
    Pose T_world_body;
    osg::ref_ptr<osg::MatrixTransform> transform;  // T_sonar_body of the current ping
  };

  osg::ref_ptr<EglContext> context;
  std::string description;
  std::unique_ptr<VideoMemory> video_memory;  // what it holds goes first
  osg::ref_ptr<osg::Group> scene;
  std::vector<BodyNode> bodies;
  std::vector<osg::ref_ptr<osg::MatrixTransform>> parts;  // of all bodies
  std::vector<Surface> surfaces;
  std::unordered_map<const osg::StateSet*, NormalMapTexture*> normal_maps;  // of the surfaces
  std::map<std::string, osg::ref_ptr<osg::Program>> programs;               // by surface_shader_head()
  MeshCache<osg::ref_ptr<osg::Group>> replacements;                         // chunks of meshes
  std::list<ViewTarget> targets;                                            // the last used first
  double target_pixels = 0;                                                 // of all of them
  std::uint64_t calls = 0;                                                  // of sample()
  float max_range_m = 0.0F;
  Drawn drawn;
  float bend_per_m = 0.0F;
  int max_texture_px = 0;

  Impl(const World& world, const GpuOptions& options) : context(new EglContext(options.device)) {
    // Near things first: what they hide is not shaded.
    osgUtil::RenderBin::setDefaultRenderBinSortMode(osgUtil::RenderBin::SORT_FRONT_TO_BACK);
    context->realize();
    context->make_current_or_throw();
    description = "gpu, " + context->describe();
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_px);
    video_memory = std::make_unique<VideoMemory>(*context->getState(), options.memory_mib << 20);
    scene = new osg::Group;
    set_up_state(*scene->getOrCreateStateSet());
    program(Shading::geometric_normal, {}, false);  // an OpenGL that cannot build it is found out here
    add_bodies(world);
  }

  ~Impl() {
    if (context->makeCurrent()) {
      video_memory->release_all();
      for (const ViewTarget& target : targets) {
        target.scene_view->releaseAllGLObjects();
      }
      scene->releaseGLObjects(context->getState());
      osg::flushAllDeletedGLObjects(context->getState()->getContextID());
    } else {
      video_memory->forget_all();
    }
    targets.clear();
    context->close();
  }

  void add_bodies(const World& world) {
    const BodyPart* last = nullptr;  // tiles of a terrain follow each other and share the surface
    for (const Body& body : world.bodies) {
      BodyNode node{body.T_world_body, new osg::MatrixTransform};
      for (const BodyPart& part : body.parts) {
        if (last == nullptr || !same_surface(*last, part)) {
          surfaces.push_back(make_surface(part));
          if (surfaces.back().normal_map) {
            normal_maps[surfaces.back().state] = surfaces.back().normal_map.get();
          }
        }
        last = &part;
        parts.push_back(make_part(part, surfaces.back(), &max_range_m));
        node.transform->addChild(parts.back());
      }
      scene->addChild(node.transform);
      bodies.push_back(node);
    }
  }

  void set_up_state(osg::StateSet& state) {
    state.setAttributeAndModes(
        new osg::ClipControl(osg::ClipControl::LOWER_LEFT, osg::ClipControl::ZERO_TO_ONE));
    state.setAttributeAndModes(new osg::Depth(osg::Depth::GREATER, 0.0, 1.0));
    state.setAttribute(new osg::CullFace(osg::CullFace::BACK));  // on only when back faces are to be dropped
    state.setMode(GL_LIGHTING, osg::StateAttribute::OFF);
    state.setMode(GL_BLEND, osg::StateAttribute::OFF);
    state.addUniform(new osg::Uniform("normal_map", normal_map_unit));
  }

  /// Built when first asked for.
  osg::ref_ptr<osg::Program> program(Shading shading, const SurfaceModel& surface, bool bent) {
    const std::string head = surface_shader_head(shading, surface, bent);
    osg::ref_ptr<osg::Program>& known = programs[head];
    if (!known) {
      known = context->build_program(
          {new osg::Shader(osg::Shader::VERTEX, head + surface_corner + surface_vertex_shader),
           new osg::Shader(osg::Shader::GEOMETRY, head + surface_corner + surface_geometry_shader),
           new osg::Shader(osg::Shader::FRAGMENT, head + surface_fragment_shader)},
          "the surface shader");
    }
    return known;
  }

  void set_surface(const SurfaceModel& surface) {
    for (const Surface& one : surfaces) {
      one.state->setAttributeAndModes(program(one.shading, surface, bend_per_m != 0.0F));
    }
    osg::StateSet& state = *scene->getStateSet();
    state.getOrCreateUniform("sigmoid", osg::Uniform::FLOAT_VEC2)
        ->set(
            osg::Vec2(static_cast<float>(surface.sigmoid_slope), static_cast<float>(surface.sigmoid_centre)));
    state.getOrCreateUniform("attenuation_per_m", osg::Uniform::FLOAT)
        ->set(static_cast<float>(surface.attenuation_per_m));
    state.setMode(GL_CULL_FACE, surface.two_sided ? osg::StateAttribute::OFF : osg::StateAttribute::ON);
  }

  /// A target for every view, aimed at it.
  std::vector<ViewTarget*> targets_for(const std::vector<SubView>& views, const Refraction& bend) {
    ++calls;
    std::vector<ViewTarget*> found;
    for (const SubView& view : views) {
      if (view.columns > max_texture_px || view.rows > max_texture_px) {
        throw RequestError("sampling: a view exceeds the GL limit of " + std::to_string(max_texture_px) +
                           " pixels");
      }
      found.push_back(&target_for(view));
      aim(*found.back(), view, bend);
    }
    release_unused();
    return found;
  }

  ViewTarget& target_for(const SubView& view) {
    const auto free = std::find_if(targets.begin(), targets.end(), [&](const ViewTarget& target) {
      return target.columns == view.columns && target.rows == view.rows && target.used != calls;
    });
    if (free != targets.end()) {
      targets.splice(targets.begin(), targets, free);
    } else {
      targets.push_front(make_target(view.columns, view.rows, scene, context->getState()));
      target_pixels += targets.front().pixels();
    }
    targets.front().used = calls;
    return targets.front();
  }

  void release_unused() {
    const std::size_t before = targets.size();
    while (targets.back().used != calls &&
           (target_pixels > most_kept_pixels || targets.size() > most_kept_targets)) {
      const ViewTarget& target = targets.back();
      target_pixels -= target.pixels();
      osg::Camera& camera = *target.scene_view->getCamera();
      camera.removeChildren(0, camera.getNumChildren());  // the scene, whose programs and maps stay
      camera.releaseGLObjects(context->getState());
      target.scene_view->getRenderStage()->releaseGLObjects(context->getState());
      targets.pop_back();
    }
    if (targets.size() < before) {
      osg::flushAllDeletedGLObjects(context->getState()->getContextID());
    }
  }

  /// All views of a ping. Does not wait for the drawing to end.
  /// @param clear what of a view is cleared. On an H200 the samples take two fifths of what a view takes in
  /// all.
  std::vector<ViewTarget*> draw(const Pose& T_world_sonar, const SampleGrid& grid,
                                const SurfaceModel& surface, double range_m, GLbitfield clear) {
    context->make_current_or_throw();
    const Refraction bend{glm::vec3(glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1)),
                          bend_per_m};
    std::vector<ViewTarget*> views = targets_for(grid.views, bend);
    set_surface(surface);
    max_range_m = static_cast<float>(range_m);
    for (const BodyNode& body : bodies) {
      body.transform->setMatrix(to_osg(relative(T_world_sonar, body.T_world_body)));
    }
    Stopwatch watch;
    DrawList list;
    for (const ViewTarget* target : views) {
      target->scene_view->cull();
      collect(*target->scene_view->getRenderStage(), normal_maps, list);
      drawn.pixels += static_cast<std::uint64_t>(target->pixels());
    }
    drawn.views += views.size();
    drawn.draw_calls += list.draw_calls;
    drawn.triangles += list.triangles;
    drawn.culling_s += watch.lap();
    video_memory->hold(list.items);
    for (const ViewTarget* target : views) {
      target->scene_view->getRenderStage()->setClearMask(clear);
      target->scene_view->draw();
    }
    check_gl_errors("drawing the scene");
    return views;
  }

  osg::Texture::TextureObject& on_gpu(const osg::Texture2D& texture) const {
    return *texture.getTextureObject(context->getState()->getContextID());
  }

  /// Waits for the drawing to end.
  void read(ViewTarget& target) const {
    target.samples.resize(static_cast<std::size_t>(target.columns) * static_cast<std::size_t>(target.rows));
    on_gpu(*target.samples_texture).bind();
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, target.samples.data());
    context->getState()->haveAppliedTextureAttribute(context->getState()->getActiveTextureUnit(),
                                                     osg::StateAttribute::TEXTURE);
    check_gl_errors("drawing the scene");
    context->check();
  }
};

RasterSampler::RasterSampler(const World& world, const GpuOptions& options)
    : impl_(std::make_unique<Impl>(world, options)) {}
RasterSampler::~RasterSampler() = default;

std::vector<const SurfaceSample*> RasterSampler::sample(const Pose& T_world_sonar, const SampleGrid& grid,
                                                        const SurfaceModel& surface, double max_range_m) {
  static_assert(sizeof(SurfaceSample) == 4 * sizeof(float), "must match one RGBA32F pixel");
  std::vector<const SurfaceSample*> samples;
  // All views are drawn before the first is read.
  for (ViewTarget* target :
       impl_->draw(T_world_sonar, grid, surface, max_range_m, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT)) {
    impl_->read(*target);
    samples.push_back(target->samples.data());
  }
  return samples;
}

std::vector<RasterSampler::ViewTextures> RasterSampler::draw(const Pose& T_world_sonar,
                                                             const SampleGrid& grid,
                                                             const SurfaceModel& surface,
                                                             double max_range_m) {
  std::vector<ViewTextures> textures;
  for (const ViewTarget* target :
       impl_->draw(T_world_sonar, grid, surface, max_range_m, GL_DEPTH_BUFFER_BIT)) {
    textures.push_back(
        {impl_->on_gpu(*target->samples_texture).id(), impl_->on_gpu(*target->depth_texture).id()});
  }
  return textures;
}

EglContext& RasterSampler::current_context() {
  impl_->context->make_current_or_throw();
  return *impl_->context;
}

void RasterSampler::make_current_if_alive() {
  impl_->context->makeCurrent();
}

void RasterSampler::set_body_pose(std::size_t body, const Pose& T_world_body) {
  impl_->bodies[body].T_world_body = T_world_body;
}

void RasterSampler::set_part_meshes(std::span<const PartMesh> changes) {
  impl_->context->make_current_or_throw();
  for (const PartMesh& change : changes) {
    osg::MatrixTransform& part = *impl_->parts[change.part];
    osg::ref_ptr<osg::Group> chunks;
    if (const auto* known = impl_->replacements.find(change.mesh.get())) {
      chunks = *known;
    } else {
      chunks = new osg::Group;
      add_chunks(*change.mesh, &impl_->max_range_m, *chunks);
      impl_->replacements.keep(change.mesh, chunks);
    }
    part.removeChildren(0, part.getNumChildren());
    part.addChild(chunks);
  }
}

void RasterSampler::set_refraction(double bend_per_m) {
  impl_->bend_per_m = static_cast<float>(bend_per_m);
}

const VideoMemory& RasterSampler::video_memory() const {
  return *impl_->video_memory;
}

const std::string& RasterSampler::description() const {
  return impl_->description;
}

const RasterSampler::Drawn& RasterSampler::drawn() const {
  return impl_->drawn;
}

}  // namespace sonard::render
