// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_sampler.hpp"

#include <algorithm>
#include <cstdint>
#include <list>
#include <map>
#include <unordered_map>

#include <osg/Camera>
#include <osg/ClipControl>
#include <osg/Depth>
#include <osg/FrameBufferObject>
#include <osg/GLExtensions>
#include <osg/MatrixTransform>
#include <osg/Program>
#include <osg/RenderInfo>
#include <osg/Texture2D>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/engines/gpu/raster_part.hpp"
#include "renderer/engines/gpu/surface_shader.hpp"
#include "renderer/engines/gpu/view_culler.hpp"
#include "renderer/errors.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

/// Where views of one size are drawn, and the copy that is read back.
struct ViewTarget {
  int columns = 0, rows = 0;
  osg::ref_ptr<osg::Texture2D> samples_texture, depth_texture;
  osg::ref_ptr<osg::FrameBufferObject> framebuffer;
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

ViewTarget make_target(int columns, int rows) {
  ViewTarget target;
  target.columns = columns;
  target.rows = rows;
  target.samples_texture = make_texture(columns, rows, GL_RGBA32F_ARB, GL_RGBA);
  target.depth_texture = make_texture(columns, rows, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);
  target.framebuffer = new osg::FrameBufferObject;
  target.framebuffer->setAttachment(osg::Camera::COLOR_BUFFER0,
                                    osg::FrameBufferAttachment(target.samples_texture.get()));
  target.framebuffer->setAttachment(osg::Camera::DEPTH_BUFFER,
                                    osg::FrameBufferAttachment(target.depth_texture.get()));
  return target;
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
  std::unique_ptr<ViewCuller> culler;
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
    context->realize();
    context->make_current_or_throw();
    description = "gpu, " + context->describe();
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_px);
    video_memory = std::make_unique<VideoMemory>(*context->getState(), options.memory_mib << 20);
    scene = new osg::Group;
    culler = std::make_unique<ViewCuller>(*context->getState(), *scene);
    set_up_state(*scene->getOrCreateStateSet());
    program(Shading::geometric_normal, {}, false);  // an OpenGL that cannot build it is found out here
    add_bodies(world);
  }

  ~Impl() {
    if (context->makeCurrent()) {
      video_memory->release_all();
      for (const ViewTarget& target : targets) {
        release(target);
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
  }

  /// A target for every view.
  std::vector<ViewTarget*> targets_for(const std::vector<SubView>& views) {
    ++calls;
    std::vector<ViewTarget*> found;
    for (const SubView& view : views) {
      if (view.columns > max_texture_px || view.rows > max_texture_px) {
        throw RequestError("sampling: a view exceeds the GL limit of " + std::to_string(max_texture_px) +
                           " pixels");
      }
      found.push_back(&target_for(view));
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
      targets.push_front(make_target(view.columns, view.rows));
      target_pixels += targets.front().pixels();
    }
    targets.front().used = calls;
    return targets.front();
  }

  void release(const ViewTarget& target) const {
    for (osg::Object* object : {static_cast<osg::Object*>(target.samples_texture.get()),
                                static_cast<osg::Object*>(target.depth_texture.get()),
                                static_cast<osg::Object*>(target.framebuffer.get())}) {
      object->releaseGLObjects(context->getState());
    }
  }

  void release_unused() {
    const std::size_t before = targets.size();
    while (targets.back().used != calls &&
           (target_pixels > most_kept_pixels || targets.size() > most_kept_targets)) {
      target_pixels -= targets.back().pixels();
      release(targets.back());
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
    const std::vector<ViewTarget*> found = targets_for(grid.views);
    set_surface(surface);
    max_range_m = static_cast<float>(range_m);
    for (const BodyNode& body : bodies) {
      body.transform->setMatrix(to_osg(relative(T_world_sonar, body.T_world_body)));
    }
    Stopwatch watch;
    const std::vector<CulledView> culled = cull(grid.views);
    drawn.culling_s += watch.lap();
    const Refraction bend{glm::vec3(glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1)),
                          bend_per_m};
    osg::State& state = *context->getState();
    glClearColor(0, 0, 0, 0);
    glClearDepth(0);
    state.pushStateSet(scene->getStateSet());
    state.apply();
    for (std::size_t v = 0; v < found.size(); ++v) {
      found[v]->framebuffer->apply(state);
      // Which makes its textures the first time.
      state.haveAppliedTextureAttribute(state.getActiveTextureUnit(), osg::StateAttribute::TEXTURE);
      glViewport(0, 0, found[v]->columns, found[v]->rows);
      glClear(clear);
      draw(grid.views[v], culled[v], bend);
    }
    state.popStateSet();
    gl().glBindFramebuffer(GL_FRAMEBUFFER_EXT, 0);
    check_gl_errors("drawing the scene");
    return found;
  }

  osg::GLExtensions& gl() const { return *context->getState()->get<osg::GLExtensions>(); }

  /// Everything that is drawn is then in video memory.
  std::vector<CulledView> cull(const std::vector<SubView>& views) {
    std::vector<CulledView> culled;
    std::vector<VideoMemory::Item*> items;
    for (const SubView& view : views) {
      culled.push_back(culler->cull(view, bend_per_m != 0.0F));
      const osg::StateSet* last = nullptr;
      for (const CulledView::Leaf& leaf : culled.back().leaves) {
        items.push_back(leaf.chunk);
        drawn.triangles += leaf.chunk->triangles();
        if (leaf.surface != last) {
          last = leaf.surface;
          if (const auto map = normal_maps.find(last); map != normal_maps.end()) {
            items.push_back(map->second);
          }
        }
      }
      drawn.draw_calls += culled.back().leaves.size();
      drawn.pixels += static_cast<std::uint64_t>(view.columns) * static_cast<std::uint64_t>(view.rows);
    }
    drawn.views += views.size();
    video_memory->hold(items);
    return culled;
  }

  /// Into what is bound.
  void draw(const SubView& view, const CulledView& culled, const Refraction& bend) const {
    osg::State& state = *context->getState();
    osg::RenderInfo info(&state, nullptr);
    const osg::Vec3 up =
        osg::Matrixd::transform3x3(osg::Vec3(bend.up.x, bend.up.y, bend.up.z), view_matrix(view));
    const osg::StateSet* surface = nullptr;
    state.applyProjectionMatrix(culled.projection.get());
    for (const CulledView::Leaf& leaf : culled.leaves) {
      if (leaf.surface != surface) {
        surface = leaf.surface;
        state.apply(surface);
        gl().glUniform2f(at_tan_half, static_cast<float>(view.tan_half_width),
                         static_cast<float>(view.tan_half_height));
        gl().glUniform2f(at_pixels, static_cast<float>(view.columns), static_cast<float>(view.rows));
        if (!bend.straight()) {
          gl().glUniform4f(at_refraction, up.x(), up.y(), up.z(), bend.per_m);
        }
      }
      state.applyModelViewMatrix(leaf.body_to_eye.get());
      leaf.chunk->drawImplementation(info);
    }
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
