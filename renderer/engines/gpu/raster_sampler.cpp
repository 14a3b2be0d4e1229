// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/raster_sampler.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <unordered_map>

#include <osg/Camera>
#include <osg/ClipControl>
#include <osg/Depth>
#include <osg/FrameBufferObject>
#include <osg/FrontFace>
#include <osg/GLExtensions>
#include <osg/MatrixTransform>
#include <osg/Program>
#include <osg/RenderInfo>
#include <osg/Texture2DArray>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/mesh_chunk.hpp"
#include "renderer/engines/gpu/raster_part.hpp"
#include "renderer/engines/gpu/surface_shader.hpp"
#include "renderer/engines/gpu/view_culler.hpp"
#include "renderer/engines/gpu/view_layout.hpp"
#include "renderer/errors.hpp"
#include "renderer/scene/mesh_cache.hpp"
#include "renderer/scene/refraction.hpp"
#include "renderer/stopwatch.hpp"

namespace sonard::render {

namespace {

osg::ref_ptr<osg::Texture2DArray> make_samples(const ViewLayout& size) {
  osg::ref_ptr<osg::Texture2DArray> texture = new osg::Texture2DArray;
  texture->setTextureSize(size.width, size.height, size.layers);
  texture->setInternalFormat(GL_RGBA32F_ARB);
  texture->setSourceFormat(GL_RGBA);
  texture->setSourceType(GL_FLOAT);
  texture->setFilter(osg::Texture::MIN_FILTER, osg::Texture::NEAREST);
  texture->setFilter(osg::Texture::MAG_FILTER, osg::Texture::NEAREST);
  return texture;
}

/// The textures into which views are drawn.
class ViewTarget {
 public:
  /// Makes room for a layout, if there is too little or far too much.
  void hold(const ViewLayout& layout, osg::State& state) {
    const bool fits =
        layout.width <= size_.width && layout.height <= size_.height && layout.layers <= size_.layers;
    if (fits && pixels(size_) <= std::max(most_kept_pixels, pixels(layout))) {
      return;
    }
    release(state);
    ViewLayout both = layout;
    both.width = roomy(std::max(layout.width, size_.width));
    both.height = roomy(std::max(layout.height, size_.height));
    both.layers = std::max(layout.layers, size_.layers);
    size_ = pixels(both) <= most_kept_pixels ? both : layout;
    size_.places.clear();
    samples_ = make_samples(size_);
    depths_ = new osg::RenderBuffer(size_.width, size_.height, GL_DEPTH_COMPONENT32F);
    for (int layer = 0; layer < size_.layers; ++layer) {
      osg::ref_ptr<osg::FrameBufferObject> framebuffer = new osg::FrameBufferObject;
      framebuffer->setAttachment(osg::Camera::COLOR_BUFFER0,
                                 osg::FrameBufferAttachment(samples_.get(), layer));
      framebuffer->setAttachment(osg::Camera::DEPTH_BUFFER, osg::FrameBufferAttachment(depths_.get()));
      framebuffers_.push_back(framebuffer);
    }
  }

  void release(osg::State& state) {
    if (samples_) {
      samples_->releaseGLObjects(&state);
      depths_->releaseGLObjects(&state);
      for (const auto& framebuffer : framebuffers_) {
        framebuffer->releaseGLObjects(&state);
      }
      framebuffers_.clear();
      osg::flushAllDeletedGLObjects(state.getContextID());
    }
  }

  /// Makes a layer the target of drawing.
  void bind(int layer, osg::State& state) const {
    framebuffers_[static_cast<std::size_t>(layer)]->apply(state);
    // apply() makes the textures the first time.
    state.haveAppliedTextureAttribute(state.getActiveTextureUnit(), osg::StateAttribute::TEXTURE);
  }

  unsigned samples(const osg::State& state) const {
    return samples_->getTextureObject(state.getContextID())->id();
  }

 private:
  // Textures of up to this many pixels, 16 bytes each, are kept, because making them takes as long as
  // drawing.
  static constexpr double most_kept_pixels = 0x1p25;

  /// Rounds up, because the next pass is of similar size. Limits of OpenGL are multiples of 512 too.
  static int roomy(int px) { return (px + 511) / 512 * 512; }
  static double pixels(const ViewLayout& size) { return 1.0 * size.width * size.height * size.layers; }

  ViewLayout size_;
  osg::ref_ptr<osg::Texture2DArray> samples_;
  osg::ref_ptr<osg::RenderBuffer> depths_;                          // of the current layer
  std::vector<osg::ref_ptr<osg::FrameBufferObject>> framebuffers_;  // of the layers
};

}  // namespace

struct RasterSampler::Impl {
  struct BodyNode {
    Pose T_world_body;
    osg::ref_ptr<osg::MatrixTransform> transform;  // T_sonar_body of the current ping
  };

  osg::ref_ptr<EglContext> context;
  std::string description;
  std::unique_ptr<VideoMemory> video_memory;  // declared before its items, which are destroyed first
  osg::ref_ptr<osg::Group> scene;
  osg::ref_ptr<osg::StateSet> unseen;  // draws pixels without a surface
  std::unique_ptr<ViewCuller> culler;
  std::vector<BodyNode> bodies;
  std::vector<osg::ref_ptr<osg::MatrixTransform>> parts;  // of all bodies
  std::vector<Surface> surfaces;
  std::unordered_map<const osg::StateSet*, NormalMapTexture*> normal_maps;  // of the surfaces
  std::map<std::string, osg::ref_ptr<osg::Program>> programs;               // by surface_shader_head()
  MeshCache<osg::ref_ptr<osg::Group>> replacements;                         // chunks of meshes
  ViewTarget target;
  std::vector<std::vector<SurfaceSample>> read_samples;  // of each view
  float max_range_m = 0.0F;
  Drawn drawn;
  float bend_per_m = 0.0F;
  int max_texture_px = 0;

  Impl(const World& world, const GpuOptions& options) : context(EglContext::made_current(options.device)) {
    description = "gpu, " + context->describe();
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &max_texture_px);
    video_memory = std::make_unique<VideoMemory>(*context->getState(), options.memory_mib << 20);
    scene = new osg::Group;
    culler = std::make_unique<ViewCuller>(*context->getState(), *scene);
    set_up_state(*scene->getOrCreateStateSet());
    set_up_unseen();
    program(Shading::geometric_normal, {}, false);  // fails here if OpenGL cannot build it
    add_bodies(world);
  }

  ~Impl() {
    if (context->makeCurrent()) {
      video_memory->release_all();
      target.release(*context->getState());
      scene->releaseGLObjects(context->getState());
      osg::flushAllDeletedGLObjects(context->getState()->getContextID());
    } else {
      video_memory->forget_all();
    }
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
    state.setAttributeAndModes(new osg::FrontFace(osg::FrontFace::CLOCKWISE));  // views lie on their side
    state.setMode(GL_LIGHTING, osg::StateAttribute::OFF);
    state.setMode(GL_BLEND, osg::StateAttribute::OFF);
    state.addUniform(new osg::Uniform("normal_map", normal_map_unit));
  }

  void set_up_unseen() {
    unseen = new osg::StateSet;
    unseen->setAttributeAndModes(new osg::Depth(osg::Depth::EQUAL, 0.0, 1.0));
    unseen->setMode(GL_CULL_FACE, osg::StateAttribute::OFF);
    unseen->setAttributeAndModes(
        context->build_program({new osg::Shader(osg::Shader::VERTEX, unseen_vertex_shader),
                                new osg::Shader(osg::Shader::FRAGMENT, unseen_fragment_shader)},
                               "the shader of unseen surfaces"));
  }

  /// The program of a kind of surface, built on first use.
  osg::ref_ptr<osg::Program> program(Shading shading, const SurfaceModel& surface, bool bent) {
    const std::string head = surface_shader_head(shading, surface, bent);
    osg::ref_ptr<osg::Program>& known = programs[head];
    if (!known) {
      known = context->build_program({new osg::Shader(osg::Shader::VERTEX, head + surface_vertex_shader),
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
    state.setMode(GL_CULL_FACE, surface.two_sided ? osg::StateAttribute::OFF : osg::StateAttribute::ON);
    state.getOrCreateUniform("sigmoid", osg::Uniform::FLOAT_VEC2)
        ->set(
            osg::Vec2(static_cast<float>(surface.sigmoid_slope), static_cast<float>(surface.sigmoid_centre)));
    state.getOrCreateUniform("attenuation_per_m", osg::Uniform::FLOAT)
        ->set(static_cast<float>(surface.attenuation_per_m));
  }

  /// Draws all views of a ping. Does not wait for the drawing to end.
  /// @return places of the views
  ViewLayout draw(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
                  double range_m) {
    context->make_current_or_throw();
    osg::State& state = *context->getState();
    ViewLayout layout = lay_out(grid.views, max_texture_px);
    target.hold(layout, state);
    set_surface(surface);
    max_range_m = static_cast<float>(range_m);
    for (const BodyNode& body : bodies) {
      body.transform->setMatrix(to_osg(relative(T_world_sonar, body.T_world_body)));
    }
    const std::vector<CulledView> culled = cull(grid.views);
    const Refraction bend{glm::vec3(glm::conjugate(T_world_sonar.orientation) * glm::dvec3(0, 0, 1)),
                          bend_per_m};
    state.pushStateSet(scene->getStateSet());
    state.apply();
    for (int layer = 0; layer < layout.layers; ++layer) {
      target.bind(layer, state);
      clear_depths(layout);
      for (std::size_t v = 0; v < culled.size(); ++v) {
        if (layout.places[v].layer == layer) {
          draw(grid.views[v], layout.places[v], culled[v], bend);
        }
      }
      draw_unseen(layout);
    }
    state.popStateSet();
    gl().glBindFramebuffer(GL_FRAMEBUFFER_EXT, 0);
    check_gl_errors("drawing the scene");
    return layout;
  }

  /// Clears the depths of the area with views.
  static void clear_depths(const ViewLayout& layout) {
    glClearDepth(0);
    glEnable(GL_SCISSOR_TEST);
    glScissor(0, 0, layout.width, layout.height);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_SCISSOR_TEST);
  }

  /// Fills pixels without a surface, after all views of the layer are drawn.
  void draw_unseen(const ViewLayout& layout) const {
    context->getState()->apply(unseen);
    glViewport(0, 0, layout.width, layout.height);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  osg::GLExtensions& gl() const { return *context->getState()->get<osg::GLExtensions>(); }

  /// Culls all views and uploads everything that will be drawn.
  std::vector<CulledView> cull(const std::vector<SubView>& views) {
    Stopwatch watch;
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
    drawn.culling_s += watch.lap();
    video_memory->hold(items);
    return culled;
  }

  /// Draws a view into the bound layer.
  void draw(const SubView& view, const ViewLayout::Place& place, const CulledView& culled,
            const Refraction& bend) const {
    osg::State& state = *context->getState();
    osg::RenderInfo info(&state, nullptr);
    glViewport(place.x, place.y, view.rows, view.columns);
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
        gl().glUniform2f(at_pixel, static_cast<float>(view.pixel_width()),
                         static_cast<float>(view.pixel_height()));
        gl().glUniform2f(at_corner, static_cast<float>(place.y), static_cast<float>(place.x));
        if (!bend.straight()) {
          gl().glUniform4f(at_refraction, up.x(), up.y(), up.z(), bend.per_m);
        }
      }
      state.applyModelViewMatrix(leaf.body_to_eye.get());
      const osg::Matrixd rounded = osg::Matrixf(*leaf.body_to_eye);  // as in the shader
      const osg::Vec3 eye = osg::Matrixd::inverse(rounded).getTrans() - leaf.chunk->centre();
      gl().glUniform3f(at_eye, eye.x(), eye.y(), eye.z());
      leaf.chunk->drawImplementation(info);
    }
  }

  /// Waits for the drawing to end and reads the samples.
  void read(const std::vector<SubView>& views, const ViewLayout& layout) {
    read_samples.resize(std::max(read_samples.size(), views.size()));
    for (std::size_t v = 0; v < views.size(); ++v) {
      const ViewLayout::Place& place = layout.places[v];
      target.bind(place.layer, *context->getState());
      const auto columns = static_cast<std::size_t>(views[v].columns);
      const auto rows = static_cast<std::size_t>(views[v].rows);
      std::vector<SurfaceSample> on_its_side(columns * rows);
      glReadPixels(place.x, place.y, views[v].rows, views[v].columns, GL_RGBA, GL_FLOAT, on_its_side.data());
      read_samples[v].resize(columns * rows);
      for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t column = 0; column < columns; ++column) {
          read_samples[v][row * columns + column] = on_its_side[column * rows + row];
        }
      }
    }
    gl().glBindFramebuffer(GL_FRAMEBUFFER_EXT, 0);
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
  const ViewLayout layout = impl_->draw(T_world_sonar, grid, surface, max_range_m);
  impl_->read(grid.views, layout);
  std::vector<const SurfaceSample*> samples;
  for (std::size_t v = 0; v < grid.views.size(); ++v) {
    samples.push_back(impl_->read_samples[v].data());
  }
  return samples;
}

unsigned RasterSampler::draw(const Pose& T_world_sonar, const SampleGrid& grid, const SurfaceModel& surface,
                             double max_range_m) {
  impl_->draw(T_world_sonar, grid, surface, max_range_m);
  return impl_->target.samples(*impl_->context->getState());
}

EglContext& RasterSampler::current_context() {
  impl_->context->make_current_or_throw();
  return *impl_->context;
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
