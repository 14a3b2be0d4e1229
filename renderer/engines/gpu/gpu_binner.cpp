// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_binner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <osg/GLExtensions>
#include <osg/Program>
#include <osg/State>

#include "renderer/engines/gpu/binning_shader.hpp"
#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// Bindings and locations of binning_shader.hpp.
enum Binding : GLuint { at_differences, at_parts, at_weights, at_counts, at_echo, at_open, at_solid_angles };
constexpr GLint at_lines = 0, at_beams = 1, at_weighed = 2;
constexpr GLint at_first_part = 3, at_bottom = 4, at_pixel_height = 5, at_lines_per_m = 6,
                at_units_per_sr = 7, at_most_units = 8, at_footprint = 9;
constexpr GLint at_sr_per_unit = 3, at_mean = 4, at_open_water = 5, at_least_share = 6, at_least_open = 7;

// A sum stays below 2^62 whatever the samples hold. That a beam full of unit response makes 2^48 leaves each
// sample 2^14 times its share of that: specular facets need it, a bed at grazing incidence the digits.
constexpr double units_of_fullest_beam = 0x1p48;
constexpr double most_units_of_beam = 0x1p62;

/// The layout in the shader.
struct GpuPart {
  std::int32_t column, row_begin, row_end, beam;
  std::uint32_t weights;
  float x, x_offset, width, limit_slope;
  float first_y_offset, first_height, last_y_offset, last_height;
};
static_assert(sizeof(GpuPart) == 13 * 4, "must match std430");

struct GpuCounts {
  std::uint32_t samples = 0, invalid = 0, saturated = 0;
};

GpuPart gpu_part(const SampleGrid& grid, const ColumnPart& part, int beam) {
  const SubView& view = grid.views[static_cast<std::size_t>(part.view)];
  return {part.column,
          part.row_begin,
          part.row_end,
          beam,
          static_cast<std::uint32_t>(part.weights),
          static_cast<float>(-view.tan_half_width + (part.column + 0.5) * view.pixel_width()),
          part.x_offset,
          part.width,
          part.limit_slope,
          part.first_y_offset,
          part.first_height,
          part.last_y_offset,
          part.last_height};
}

/// `value` as a sum of three floats of which the first two have no more than 12 bits.
std::array<float, 3> in_three_parts(double value) {
  const auto twelve_bits = [](double number) {
    auto rounded = static_cast<float>(number);
    std::uint32_t bits = 0;
    std::memcpy(&bits, &rounded, sizeof bits);
    bits &= 0xFFFFF000U;
    std::memcpy(&rounded, &bits, sizeof bits);
    return rounded;
  };
  const float high = twelve_bits(value);
  const float middle = twelve_bits(value - static_cast<double>(high));
  return {high, middle, static_cast<float>(value - static_cast<double>(high) - static_cast<double>(middle))};
}

/// A buffer of the GPU that shaders see at one binding.
class StorageBuffer {
 public:
  StorageBuffer(osg::GLExtensions& gl, Binding binding) : gl_(gl), binding_(binding) {
    gl_.glGenBuffers(1, &name_);
  }
  /// The context is current.
  ~StorageBuffer() { gl_.glDeleteBuffers(1, &name_); }
  StorageBuffer(const StorageBuffer&) = delete;
  StorageBuffer& operator=(const StorageBuffer&) = delete;

  template <class T>
  void fill(const std::vector<T>& values, GLenum usage) {
    gl_.glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
    gl_.glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(T)),
                     values.data(), usage);
    words_ = values.size() * sizeof(T) / sizeof(std::uint32_t);
  }
  /// If there are not so many words, makes as many, of zeros.
  void hold(std::size_t words) {
    if (words_ < words) {
      fill(std::vector<std::uint32_t>(words), GL_DYNAMIC_COPY);
    }
  }
  /// The next hold() starts over.
  void forget() { words_ = 0; }
  void bind() const { gl_.glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding_, name_); }
  void read(void* to, std::size_t bytes) const {
    gl_.glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
    gl_.glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), to);
  }

 private:
  osg::GLExtensions& gl_;
  Binding binding_;
  GLuint name_ = 0;
  std::size_t words_ = 0;
};

/// Whether OpenGL has run out of memory since errors were asked for last.
bool is_out_of_memory() {
  bool found = false;
  for (GLenum error = glGetError(); error != GL_NO_ERROR; error = glGetError()) {
    found = found || error == GL_OUT_OF_MEMORY;
  }
  return found;
}

}  // namespace

struct GpuBinner::Impl {
  EglContext& context;
  osg::GLExtensions& gl;
  osg::ref_ptr<osg::Program> splat, sum;
  StorageBuffer differences, parts, weights, counts, echo, open, solid_angles;
  std::size_t most_bytes = 0;  // of a buffer

  // The grid:
  std::vector<SubView> views;
  std::vector<int> view_parts;  // parts of view v: [view_parts[v], view_parts[v + 1])
  int beams = 0;
  double units_per_sr = 1.0;
  double most_units = 1.0;  // of one sample
  std::string grid_obstacle;
  // The image:
  int lines = 0;
  bool weighed = false;

  explicit Impl(EglContext& made_current)
      : context(made_current),
        gl(*osg::GLExtensions::Get(context.getState()->getContextID(), true)),
        splat(program(splat_shader)),
        sum(program(sum_shader)),
        differences(gl, at_differences),
        parts(gl, at_parts),
        weights(gl, at_weights),
        counts(gl, at_counts),
        echo(gl, at_echo),
        open(gl, at_open),
        solid_angles(gl, at_solid_angles) {
    GLint64 most = 0;
    gl.glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    // Shaders count words in 32 bits.
    most_bytes = static_cast<std::size_t>(
        std::clamp<GLint64>(most, 0, std::int64_t{4} * std::numeric_limits<std::uint32_t>::max()));
  }

  osg::ref_ptr<osg::Program> program(const char* shader) const {
    osg::ref_ptr<osg::Program> made = new osg::Program;
    made->addShader(new osg::Shader(osg::Shader::COMPUTE, std::string(binning_shader_head) + shader));
    made->compileGLObjects(*context.getState());
    if (!linked(*made).isLinked()) {
      std::string reason;
      linked(*made).getInfoLog(reason);
      throw RendererError("the binning shader does not build on " + context.describe() + ": " + reason);
    }
    return made;
  }

  osg::Program::PerContextProgram& linked(const osg::Program& made) const {
    return *made.getPCP(*context.getState());
  }

  void make_current() const {
    if (!context.makeCurrent()) {
      throw RendererError("the OpenGL context is lost");
    }
  }

  std::string obstacle_of(const char* what, double bytes) const {
    return bytes <= static_cast<double>(most_bytes)
               ? std::string()
               : fmt::format("{} of {:.0f} MiB, but a buffer of this OpenGL holds {} MiB", what,
                             bytes / 0x1p20, most_bytes >> 20U);
  }

  void set_grid(const SampleGrid& grid) {
    views = grid.views;
    beams = grid.beam_count();
    grid_obstacle = obstacle_of("a grid", static_cast<double>(grid.weights.size()) * sizeof(float));
    if (!grid_obstacle.empty()) {
      return;
    }
    std::vector<std::vector<GpuPart>> of_view(views.size());
    std::vector<double> solid_angle(static_cast<std::size_t>(beams), 0.0);
    std::size_t most_samples = 1;
    for (int beam = 0; beam < beams; ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      std::size_t samples = 0;
      for (int p = grid.beam_parts[b]; p < grid.beam_parts[b + 1]; ++p) {
        const ColumnPart& part = grid.parts[static_cast<std::size_t>(p)];
        of_view[static_cast<std::size_t>(part.view)].push_back(gpu_part(grid, part, beam));
        for (int row = part.row_begin; row < part.row_end; ++row) {
          solid_angle[b] += static_cast<double>(
              grid.weights[part.weights + static_cast<std::size_t>(row - part.row_begin)]);
        }
        samples += static_cast<std::size_t>(part.row_end - part.row_begin);
      }
      most_samples = std::max(most_samples, samples);
    }
    const double fullest = *std::max_element(solid_angle.begin(), solid_angle.end());
    units_per_sr = std::exp2(std::floor(std::log2(units_of_fullest_beam / std::max(fullest, 1e-30))));
    most_units = most_units_of_beam / static_cast<double>(most_samples);
    upload(of_view, grid.weights, solid_angle);
  }

  void upload(const std::vector<std::vector<GpuPart>>& of_view, const std::vector<float>& weight,
              const std::vector<double>& solid_angle) {
    std::vector<GpuPart> all;
    view_parts.assign(1, 0);
    for (const std::vector<GpuPart>& some : of_view) {
      all.insert(all.end(), some.begin(), some.end());
      view_parts.push_back(static_cast<int>(all.size()));
    }
    parts.fill(all, GL_STATIC_DRAW);
    weights.fill(weight, GL_STATIC_DRAW);
    solid_angles.fill(std::vector<float>(solid_angle.begin(), solid_angle.end()), GL_STATIC_DRAW);
    if (is_out_of_memory()) {
      grid_obstacle = "OpenGL has no memory for a grid of this size";
    }
  }

  /// Zeros, which every image leaves behind for the next one, whatever its layout.
  std::string make_room(int wanted_lines, const BinningOptions& options) {
    lines = wanted_lines;
    weighed = options.mean || options.open_water;
    const std::size_t words = bins() * (weighed ? 4 : 2);
    std::string obstacle = grid_obstacle.empty()
                               ? obstacle_of("an image", static_cast<double>(words) * sizeof(std::uint32_t))
                               : grid_obstacle;
    if (!obstacle.empty()) {
      return obstacle;
    }
    differences.hold(words);
    echo.hold(bins());
    open.hold(options.open_water ? bins() : 0);
    if (is_out_of_memory()) {
      forget_images();
      return "OpenGL has no memory for an image of this size";
    }
    return {};
  }

  void forget_images() {
    for (StorageBuffer* buffer : {&differences, &echo, &open}) {
      buffer->forget();
    }
  }

  void splat_views(const std::vector<unsigned>& textures, const RangeLines& range,
                   const BinningOptions& options) {
    linked(*splat).useProgram();
    set_image_uniforms();
    const double legacy = options.legacy_bin_index ? (range.count - 1.0) / range.count : 1.0;
    const std::array<float, 3> lines_per_m = in_three_parts(legacy / range.step_m);
    gl.glUniform3fv(at_lines_per_m, 1, lines_per_m.data());
    gl.glUniform1f(at_units_per_sr, static_cast<float>(units_per_sr));
    gl.glUniform1f(at_most_units, static_cast<float>(most_units));
    gl.glUniform1i(at_footprint, options.footprint ? 1 : 0);
    for (std::size_t v = 0; v < views.size(); ++v) {
      const SubView& view = views[v];
      gl.glUniform1i(at_first_part, view_parts[v]);
      gl.glUniform1f(at_bottom, static_cast<float>(-view.tan_half_height + 0.5 * view.pixel_height()));
      gl.glUniform1f(at_pixel_height, static_cast<float>(view.pixel_height()));
      gl.glBindImageTexture(0, textures[v], 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32F_ARB);
      if (const int count = view_parts[v + 1] - view_parts[v]; count > 0) {
        gl.glDispatchCompute(static_cast<GLuint>(count), 1, 1);
      }
    }
    gl.glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  void sum_beams(const BinningOptions& options) {
    linked(*sum).useProgram();
    set_image_uniforms();
    gl.glUniform1i(at_mean, options.mean ? 1 : 0);
    gl.glUniform1i(at_open_water, options.open_water ? 1 : 0);
    gl.glUniform1f(at_least_share, least_share);
    gl.glUniform1f(at_least_open, static_cast<float>(least_open));
    gl.glUniform1f(at_sr_per_unit, static_cast<float>(1.0 / units_per_sr));
    gl.glDispatchCompute(static_cast<GLuint>(beams), 1, 1);
    gl.glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  }

  void set_image_uniforms() const {
    gl.glUniform1i(at_lines, lines);
    gl.glUniform1i(at_beams, beams);
    gl.glUniform1i(at_weighed, weighed ? 1 : 0);
  }

  BinningResult bin(const std::vector<unsigned>& textures, const RangeLines& range,
                    const BinningOptions& options, std::vector<float> memory) {
    counts.fill(std::vector<GpuCounts>(1), GL_DYNAMIC_READ);
    for (const StorageBuffer* buffer :
         {&differences, &parts, &weights, &counts, &echo, &open, &solid_angles}) {
      buffer->bind();
    }
    splat_views(textures, range, options);
    sum_beams(options);
    gl.glUseProgram(0);
    context.getState()->setLastAppliedProgramObject(nullptr);

    BinningResult result;
    result.beams = beams;
    result.lines = lines;
    result.echo = std::move(memory);
    result.echo.resize(bins());
    echo.read(result.echo.data(), bins() * sizeof(float));
    if (options.open_water) {
      result.open_sr.resize(bins());
      open.read(result.open_sr.data(), bins() * sizeof(float));
    }
    GpuCounts counted;
    counts.read(&counted, sizeof counted);
    result.samples = counted.samples;
    result.invalid_samples = counted.invalid;
    result.saturated_samples = counted.saturated;
    if (const GLenum error = glGetError(); error != GL_NO_ERROR) {
      forget_images();  // what is left in there is not known
      throw RendererError("OpenGL error " + std::to_string(error) + " while binning");
    }
    return result;
  }

  std::size_t bins() const { return static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines); }
};

GpuBinner::GpuBinner(RasterSampler& sampler) : impl_(std::make_unique<Impl>(sampler.current_context())) {}

GpuBinner::~GpuBinner() {
  if (impl_->context.makeCurrent()) {
    impl_->splat->releaseGLObjects(impl_->context.getState());
    impl_->sum->releaseGLObjects(impl_->context.getState());
  }
}

void GpuBinner::set_grid(const SampleGrid& grid) {
  impl_->make_current();
  impl_->set_grid(grid);
}

std::string GpuBinner::make_room(int lines, const BinningOptions& options) {
  impl_->make_current();
  return impl_->make_room(lines, options);
}

BinningResult GpuBinner::bin(const std::vector<unsigned>& textures, const RangeLines& range,
                             const BinningOptions& options, std::vector<float> memory) {
  impl_->make_current();
  return impl_->bin(textures, range, options, std::move(memory));
}

}  // namespace sonard::render
