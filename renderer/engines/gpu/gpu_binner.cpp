// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_binner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <osg/GLExtensions>
#include <osg/Program>
#include <osg/State>

#include "renderer/engines/gpu/binning_shader.hpp"
#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/estimate_shader.hpp"
#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/gpu_grid.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// A sum must stay below 2^62 for any samples. A beam full of unit response makes 2^40, as in RangeProfile.
// Each sample may then have up to 2^22 times its share, which specular facets need in part. Means of mode
// `paper` divide the small echo of a line by its small weight, so they need more digits; their responses are
// below 1.
constexpr double units_of_fullest_beam = 0x1p40;
constexpr double units_of_fullest_beam_of_means = 0x1p48;
constexpr double most_units_of_beam = 0x1p62;

constexpr double least_level = 1e-2;  // of the beam's maximum; errors are estimated over bins above it
constexpr double zone_rest = 0.5;     // largest error outside a zone, re the error that counts as 1
// The shaders have the same values:
constexpr std::uint32_t start_of_sum = 0x80000000;
constexpr std::size_t group_size = 64;
// Texture units; OpenSceneGraph uses the lowest. The use of first_unit to fourth_unit depends on the shader.
enum TextureUnit : unsigned {
  samples_unit = 7,
  first_unit,
  second_unit,
  third_unit,
  fourth_unit,
  line_weight_unit,
  parts_unit,
  views_unit,
};
constexpr GLbitfield written_by_shaders = GL_SHADER_STORAGE_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT;
constexpr std::size_t image_header_bytes = 20;
constexpr std::size_t most_view_rows = 16384;
constexpr const char* doing = "binning";

/// The shaders use the same layout.
struct ImageHeader {
  std::uint32_t samples = 0, invalid = 0, saturated = 0, additions = 0, pairs = 0;
};
static_assert(sizeof(ImageHeader) == image_header_bytes, "must match std430");
static_assert(sizeof(BeamEstimate) == 10 * 4, "must match std430");

/// `value` as a sum of three floats; the first two have at most 12 bits.
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

GLuint groups_of(std::size_t invocations) {
  return static_cast<GLuint>((invocations + group_size - 1) / group_size);
}

}  // namespace

struct GpuBinner::Impl {
  EglContext& context;
  osg::GLExtensions& gl;
  /// Key: the head of a variant, and the last part of the shader.
  using Programs = std::map<std::pair<std::string, const char*>, osg::ref_ptr<osg::Program>>;
  std::shared_ptr<Programs> programs;
  // Differences between lines of the current grid.
  GpuBuffer echo, weight, thinned, thinned_weight;
  std::vector<std::unique_ptr<GpuBuffer>> pages;  // of the image
  GpuBuffer line_weight, partial_columns, columns, rows, column_misses, estimates;
  GpuReadback estimates_back, image_back;
  std::size_t most_bytes = 0;  // of a buffer
  const int most_view_px;
  /// Number of invocations per column and per beam. A CPU runs eight at once; more would only cost, because
  /// each invocation reads its column, and the invocations of a beam wait for each other.
  const std::size_t column_group, beam_group;
  std::vector<float> line_weights;

  std::optional<ImageRequest> request;  // the current image
  std::size_t estimated = 0;            // beams whose estimates have not been requested
  std::size_t estimates_asked = 0;      // beams whose estimates have been requested and not taken
  Traffic traffic;                      // of the current image

  Impl(EglContext& made_current, int view_px, std::shared_ptr<Programs> shared)
      : context(made_current),
        gl(*osg::GLExtensions::Get(context.getState()->getContextID(), true)),
        programs(shared ? std::move(shared) : std::make_shared<Programs>()),
        echo(gl),
        weight(gl),
        thinned(gl),
        thinned_weight(gl),
        line_weight(gl),
        partial_columns(gl),
        columns(gl),
        rows(gl),
        column_misses(gl),
        estimates(gl),
        estimates_back(gl),
        image_back(gl),
        most_view_px(view_px),
        column_group(context.software() ? 8 : 64),
        beam_group(context.software() ? 8 : 32) {
    GLint64 most = 0;
    gl.glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &most);
    GLint most_texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most_texels);
    most_texels = std::min(most_texels, 1 << 28);  // shaders count them in integers, twice for open water
    most = std::min<GLint64>(most, GLint64{most_texels} * sizeof(std::uint64_t));  // sums: smallest texels
    // Shaders count words in 32 bits.
    most_bytes = static_cast<std::size_t>(
        std::clamp<GLint64>(most, 0, std::int64_t{4} * std::numeric_limits<std::uint32_t>::max()));
    // Builds the shaders of presets now, so that the constructor fails if OpenGL cannot build them.
    for (const std::vector<const char*>& shader : {splatting, std::vector{column_shader}, row_summing,
                                                   std::vector{sum_shader}, std::vector{estimate_shader}}) {
      use({}, shader);
    }
    gl.glUseProgram(0);
  }

  inline static const std::vector<const char*> splatting{sample_shader_head, strip_shader_head, splat_shader};
  inline static const std::vector<const char*> row_summing{sample_shader_head, strip_shader_head, row_shader};

  /// Compile-time options of a shader, because a software OpenGL runs both sides of every branch.
  struct Variant {
    bool weighed = false;   ///< weights are summed too
    bool thinned = false;   ///< uses every second column and row of the samples
    bool estimate = false;  ///< echoes of columns are summed too
    bool footprint = true;
    bool paired = false;  ///< two samples may be binned as one
    Aperture::Elevation elevation = Aperture::Elevation::top_hat;
  };

  /// Makes a program current; it is built on first use.
  void use(const Variant& variant, const std::vector<const char*>& shader) {
    const std::string head = fmt::format(
        "#version 430\n#define COLUMN_GROUP {}\n#define BEAM_GROUP {}\n#define WEIGHED {:d}\n#define THINNED "
        "{:d}\n#define ESTIMATE {:d}\n#define FOOTPRINT {:d}\n#define PAIRED {:d}\n#define PATTERN {}\n",
        column_group, beam_group, variant.weighed, variant.thinned, variant.estimate, variant.footprint,
        variant.paired, static_cast<int>(variant.elevation));
    osg::ref_ptr<osg::Program>& program = (*programs)[{head, shader.back()}];
    if (!program) {
      std::string source = head + binning_shader_head;
      for (const char* part : shader) {
        source += part;
      }
      program = context.build_program({new osg::Shader(osg::Shader::COMPUTE, source)}, "a binning shader");
    }
    program->getPCP(*context.getState())->useProgram();
    gl.glUniform1i(at_lines, request ? lines() : 1);
  }

  /// @throws RequestError
  void check_size(std::size_t bytes, const char* what) const {
    if (bytes > most_bytes) {
      throw RequestError(fmt::format("sampling: {} needs {} MiB, but this OpenGL limits buffers to {} MiB",
                                     what, bytes >> 20U, most_bytes >> 20U));
    }
  }

  /// @throws RequestError
  void hold(GpuBuffer& buffer, std::size_t bytes, const char* what) {
    check_size(bytes, what);
    if (buffer.bytes() < bytes) {
      buffer.hold(std::min(bytes + bytes / 4, most_bytes));  // views differ from ping to ping
    }
  }

  /// Sets sums to their start value.
  void begin_sums(GpuBuffer& buffer, std::size_t bytes) {
    hold(buffer, bytes, "beams");
    buffer.clear(bytes, {start_of_sum, 0});
  }

  /// Units of the sums per steradian, a power of two.
  double units_per_sr(const GpuGrid& grid) const {
    const double fullest = request->options.mean ? units_of_fullest_beam_of_means : units_of_fullest_beam;
    return std::exp2(std::floor(std::log2(fullest / std::max(grid.fullest_beam_sr, 1e-30))));
  }
  bool weighed() const { return request->options.mean || request->options.open_water; }
  int lines() const { return request->range.count; }
  std::size_t bins_of(int beams) const {
    return static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines());
  }

  // ---- pages

  int beams_per_page() const {
    const std::size_t of_lines = most_bytes / (bins_of(1) * sizeof(std::uint64_t) + image_header_bytes);
    const std::size_t of_rows = most_bytes / (most_view_rows * 4 * sizeof(float));
    return static_cast<int>(std::clamp<std::size_t>(std::min(of_lines, of_rows), 1, 1U << 20U));
  }
  int beams_of_page(int page) const {
    return std::min(beams_per_page(), request->beams - page * beams_per_page());
  }
  std::size_t bytes_of_page(int page) const {
    return image_header_bytes +
           bins_of(beams_of_page(page)) * (request->options.open_water ? 2 : 1) * sizeof(float);
  }
  int page_count() const { return (request->beams + beams_per_page() - 1) / beams_per_page(); }
  int page_of(const GpuGrid& grid) const { return grid.first_beam / beams_per_page(); }

  void begin(const ImageRequest& what) {
    request.emplace(what);
    estimated = 0;
    traffic = {};
    for (int page = 0; page < page_count(); ++page) {
      if (pages.size() == static_cast<std::size_t>(page)) {
        pages.push_back(std::make_unique<GpuBuffer>(gl));
      }
      GpuBuffer& buffer = *pages[static_cast<std::size_t>(page)];
      hold(buffer, bytes_of_page(page), "an image");
      buffer.write(std::vector<ImageHeader>(1));
      traffic.bytes_uploaded += image_header_bytes;
    }
    std::vector<float> weights = what.line_weight;
    weights.resize(static_cast<std::size_t>(lines()), 1.0F);
    if (weights != line_weights) {
      line_weight.fill(weights);
      traffic.bytes_uploaded += line_weight.bytes();
      line_weights = std::move(weights);
    }
    check_memory("an image");
  }

  /// @throws RequestError, RendererError
  void check_memory(const char* what) {
    const GlErrors errors = take_gl_errors();
    if (errors.other != 0) {
      forget();
      throw RendererError(errors.text(doing));
    }
    if (errors.out_of_memory) {
      forget();
      throw RequestError(fmt::format("sampling: OpenGL has no memory for {} of this size", what));
    }
  }

  /// Drops the contents of all buffers, which are undefined after an error.
  void forget() {
    for (GpuBuffer* buffer : {&echo, &weight, &thinned, &thinned_weight, &partial_columns, &columns, &rows,
                              &column_misses, &estimates}) {
      buffer->forget();
    }
    line_weights.clear();
    pages.clear();
  }

  void make_room(const GpuGrid& grid) {
    const std::size_t words = grid.beam_count * static_cast<std::size_t>(lines()) * sizeof(std::uint64_t);
    begin_sums(echo, words);
    begin_sums(weight, weighed() ? words : sizeof(std::uint64_t));
    if (grid.thinned) {
      begin_sums(thinned, words);
      begin_sums(thinned_weight, request->options.mean ? words : sizeof(std::uint64_t));
      hold(partial_columns, grid.columns.part_count * column_group * 2 * sizeof(float), "columns");
      hold(columns, grid.columns.part_count * 2 * sizeof(float), "columns");
      hold(column_misses, grid.columns.part_count * sizeof(float), "columns");
      hold(rows, grid.beam_count * static_cast<std::size_t>(grid.estimated_rows) * 4 * sizeof(float), "rows");
    }
    hold(estimates, static_cast<std::size_t>(request->beams) * sizeof(BeamEstimate), "estimates");
    check_memory("beams");
  }

  /// Sets the uniforms of sample_shader_head.
  void set_pattern(const GpuGrid& grid) const {
    const double legacy = request->options.legacy_bin_index ? (lines() - 1.0) / lines() : 1.0;
    const std::array<float, 3> lines_per_m = in_three_parts(legacy / request->range.step_m);
    gl.glUniform3fv(at_lines_per_m, 1, lines_per_m.data());
    gl.glUniform1f(at_pattern_scale, grid.pattern_scale);
  }

  void look_at(unsigned samples) const {
    gl.glActiveTexture(GL_TEXTURE0 + samples_unit);
    glBindTexture(GL_TEXTURE_2D_ARRAY, samples);
  }

  void splat(const GpuGrid& grid, const GpuColumns& of, bool is_thinned) {
    const bool estimating = grid.thinned && !is_thinned;
    const bool paired = request->paired_rows > 0 && of.most_view_rows >= request->paired_rows;
    use({is_thinned ? request->options.mean : weighed(), is_thinned, estimating, request->options.footprint,
         paired, grid.elevation},
        splatting);
    partial_columns.bind(5);
    set_pattern(grid);
    (is_thinned ? thinned : echo).bind(0);
    (is_thinned ? thinned_weight : weight).bind(1);
    of.parts.bind_texels(parts_unit, GL_RGBA32I);
    of.views.bind_texels(views_unit, GL_RGBA32I);
    pages[static_cast<std::size_t>(page_of(grid))]->bind(4);
    gl.glUniform1i(at_part_count, static_cast<GLint>(of.part_count));
    gl.glUniform1i(at_paired_rows, request->paired_rows);
    gl.glUniform1f(at_units_per_sr, static_cast<float>(units_per_sr(grid)));
    gl.glUniform1f(at_most_units, static_cast<float>(most_units_of_beam / grid.most_samples));
    const auto in_a_row = static_cast<GLuint>(std::min(of.part_count, most_groups));
    gl.glDispatchCompute(in_a_row, (static_cast<GLuint>(of.part_count) + in_a_row - 1) / in_a_row, 1);
  }

  void sum_strips(const GpuGrid& grid) {
    use({}, {column_shader});
    partial_columns.bind_texels(first_unit, GL_RG32F);
    columns.bind(1);
    gl.glUniform1i(at_part_count, static_cast<GLint>(grid.columns.part_count));
    gl.glDispatchCompute(groups_of(grid.columns.part_count), 1, 1);
    if (grid.estimated_rows == 0) {
      return;
    }
    use({false, false, false, true, false, grid.elevation}, row_summing);
    set_pattern(grid);
    rows.bind(0);
    grid.beams.bind(5);
    grid.segments.bind_texels(first_unit, GL_RGBA32I);
    grid.columns.views.bind_texels(views_unit, GL_RGBA32I);
    gl.glUniform1i(at_most_rows, grid.estimated_rows);
    gl.glUniform1f(at_tan_limit, grid.tan_limit);
    gl.glDispatchCompute(static_cast<GLuint>(grid.beam_count),
                         groups_of(static_cast<std::size_t>(grid.estimated_rows)), 1);
  }

  void sum_beams(const GpuGrid& grid) {
    const BinningOptions& options = request->options;
    use({weighed()}, {sum_shader});
    echo.bind_texels(first_unit, GL_RG32UI);
    weight.bind_texels(second_unit, GL_RG32UI);
    thinned.bind_texels(third_unit, GL_RG32UI);
    thinned_weight.bind_texels(fourth_unit, GL_RG32UI);
    pages[static_cast<std::size_t>(page_of(grid))]->bind(4);
    grid.beams.bind(5);
    estimates.bind(7);
    gl.glUniform1i(at_image_beams, beams_of_page(page_of(grid)));
    gl.glUniform1i(at_first_beam, page_of(grid) * beams_per_page());
    gl.glUniform1f(at_sr_per_unit, static_cast<float>(1.0 / units_per_sr(grid)));
    gl.glUniform1i(at_mean, options.mean ? 1 : 0);
    gl.glUniform1i(at_open_water, options.open_water ? 1 : 0);
    gl.glUniform1f(at_least_share, least_share);
    gl.glUniform1f(at_least_open, static_cast<float>(least_open));
    gl.glUniform1i(at_estimating, grid.thinned ? 1 : 0);
    gl.glUniform1f(at_least_level, static_cast<float>(least_level));
    gl.glUniform1i(at_first_estimate, static_cast<GLint>(estimated));
    gl.glDispatchCompute(static_cast<GLuint>(grid.beam_count), 1, 1);
  }

  void estimate_beams(const GpuGrid& grid) {
    use({}, {estimate_shader});
    columns.bind_texels(first_unit, GL_RG32F);
    rows.bind_texels(second_unit, GL_RGBA32F);
    grid.columns.parts.bind_texels(parts_unit, GL_RGBA32I);
    column_misses.bind(3);
    grid.beams.bind(5);
    estimates.bind(7);
    gl.glUniform1i(at_most_rows, grid.estimated_rows);
    gl.glUniform1i(at_first_estimate, static_cast<GLint>(estimated));
    gl.glUniform2f(at_most_error, static_cast<float>(request->most_error.total),
                   static_cast<float>(request->most_error.centroid_lines));
    gl.glUniform1f(at_most_rest, static_cast<float>(zone_rest * zone_rest));
    gl.glDispatchCompute(static_cast<GLuint>(grid.beam_count), 1, 1);
  }

  void add(const GpuGrid& grid, unsigned samples) {
    make_room(grid);
    look_at(samples);
    line_weight.bind_texels(line_weight_unit, GL_R32F);
    splat(grid, grid.columns, false);
    if (grid.thinned) {
      splat(grid, *grid.thinned, true);
      gl.glMemoryBarrier(written_by_shaders);
      sum_strips(grid);
    }
    gl.glMemoryBarrier(written_by_shaders);
    sum_beams(grid);
    if (grid.thinned) {
      estimate_beams(grid);
      estimated += grid.beam_count;
    }
    gl.glMemoryBarrier(written_by_shaders | GL_BUFFER_UPDATE_BARRIER_BIT);
    look_at({});
    gl.glActiveTexture(GL_TEXTURE0 + context.getState()->getActiveTextureUnit());
    gl.glUseProgram(0);
    context.getState()->setLastAppliedProgramObject(nullptr);
  }

  /// @throws RendererError
  void wait_for(GpuReadback& readback, const std::function<void(std::span<const std::byte>)>& take) {
    const bool there = readback.wait([&](std::span<const std::byte> bytes) {
      take(bytes);
      traffic.bytes_read += bytes.size();
    });
    ++traffic.synchronisations;
    context.check();
    if (const GlErrors errors = take_gl_errors(); errors.any() || !there) {
      forget();
      throw RendererError(errors.text(doing));
    }
  }

  void ask_estimates() {
    estimates_asked = estimated;
    estimated = 0;
    if (estimates_asked > 0) {
      estimates_back.ask({{estimates, estimates_asked * sizeof(BeamEstimate)}});
    }
  }

  std::vector<BeamEstimate> take_estimates() {
    std::vector<BeamEstimate> found(estimates_asked);
    if (estimates_asked > 0) {
      wait_for(estimates_back, [&](std::span<const std::byte> bytes) {
        std::memcpy(found.data(), bytes.data(), bytes.size());
      });
    }
    return found;
  }

  void ask_image() {
    std::vector<GpuReadback::Part> parts;
    for (int page = 0; page < page_count(); ++page) {
      parts.push_back({*pages[static_cast<std::size_t>(page)], bytes_of_page(page)});
    }
    image_back.ask(parts);
  }

  BinningResult take_image(std::vector<float> memory) {
    BinningResult result;
    result.beams = request->beams;
    result.lines = lines();
    result.echo = std::move(memory);
    result.echo.resize(bins_of(request->beams));
    result.open_sr.resize(request->options.open_water ? result.echo.size() : 0);
    wait_for(image_back, [&](std::span<const std::byte> bytes) { unpack_pages(bytes.data(), result); });
    return result;
  }

  void unpack_pages(const std::byte* from, BinningResult& result) {
    const auto take = [&from](void* to, std::size_t count) {
      std::memcpy(to, from, count);
      from += count;
    };
    for (int page = 0; page < page_count(); ++page) {
      const std::size_t first = bins_of(page * beams_per_page());
      const std::size_t image_bytes = bins_of(beams_of_page(page)) * sizeof(float);
      ImageHeader counted;
      take(&counted, sizeof counted);
      take(&result.echo[first], image_bytes);
      if (request->options.open_water) {
        take(&result.open_sr[first], image_bytes);
      }
      result.samples += counted.samples;
      result.invalid_samples += counted.invalid;
      result.saturated_samples += counted.saturated;
      result.skipped.add(SkipRule::coplanar_samples, counted.pairs);
      traffic.atomic_additions += counted.additions;
    }
  }
};

GpuBinner::GpuBinner(RasterSampler& sampler, const GpuBinner* other)
    : impl_(std::make_unique<Impl>(sampler.current_context(), sampler.most_view_px(),
                                   other == nullptr ? nullptr : other->impl_->programs)) {}

GpuBinner::~GpuBinner() {
  if (impl_->programs.use_count() == 1 && impl_->context.makeCurrent()) {
    for (const auto& [key, program] : *impl_->programs) {
      program->releaseGLObjects(impl_->context.getState());
    }
  }
}

std::shared_ptr<const GpuGrid> GpuBinner::load(const SampleGrid& grid, const std::vector<int>& beams,
                                               const SampleGrid* thinned) {
  impl_->context.make_current_or_throw();
  auto made = std::make_shared<const GpuGrid>(impl_->gl, grid, beams, thinned, impl_->most_view_px);
  impl_->check_memory("a grid");
  impl_->traffic.bytes_uploaded += made->bytes();
  return made;
}

void GpuBinner::begin(const ImageRequest& request) {
  impl_->context.make_current_or_throw();
  impl_->begin(request);
}

int GpuBinner::beams_per_page() const {
  return impl_->beams_per_page();
}

void GpuBinner::add(const GpuGrid& grid, unsigned samples) {
  impl_->context.make_current_or_throw();
  impl_->add(grid, samples);
}

void GpuBinner::ask_estimates() {
  impl_->context.make_current_or_throw();
  impl_->ask_estimates();
}

std::vector<BeamEstimate> GpuBinner::take_estimates() {
  impl_->context.make_current_or_throw();
  return impl_->take_estimates();
}

void GpuBinner::ask_image() {
  impl_->context.make_current_or_throw();
  impl_->ask_image();
}

BinningResult GpuBinner::take_image(std::vector<float> memory) {
  impl_->context.make_current_or_throw();
  return impl_->take_image(std::move(memory));
}

const GpuBinner::Traffic& GpuBinner::traffic() const {
  return impl_->traffic;
}

}  // namespace sonard::render
