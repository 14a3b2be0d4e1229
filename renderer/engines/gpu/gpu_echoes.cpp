// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_echoes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <osg/Program>

#include "renderer/engines/gpu/gpu_surfaces.hpp"
#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/engines/slices/elevation_pattern.hpp"
#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// Records of the shaders.

struct EchoRecord {
  float line_m;
  std::array<float, 3> lines_per_m;
  std::int32_t lines, is_physical, facets_anywhere, has_pattern;
  float displaced_m, mapped_m, facet_slopes, facet_m;
  float height, height_in_one_place, pattern_at_0, pattern_per_t;
  float sigmoid_slope, sigmoid_centre, attenuation_per_m;
  float units_per_sr, sr_per_unit;
  std::int32_t is_mean, has_open_water;
  alignas(16) std::array<float, 1028> pattern;
};

constexpr std::size_t bytes_of_piece = 32;
constexpr std::size_t bytes_of_slice_pieces = 8;
constexpr double most_units = 0x1p51;  // of a beam; bin.comp says why

/// The number as a sum of three: two of 12 bits, and the rest.
std::array<float, 3> split_in_three(double number) {
  const auto cut = [](double whole) {
    return std::bit_cast<float>(std::bit_cast<std::uint32_t>(static_cast<float>(whole)) & 0xfffff000U);
  };
  const float first = cut(number), second = cut(number - static_cast<double>(first));
  return {first, second,
          static_cast<float>(number - static_cast<double>(first) - static_cast<double>(second))};
}

double height_of(const GpuEchoes::Setting& setting) {
  return setting.options.open_water ? setting.aperture.pattern_height()
                                    : 2 * std::sin(setting.aperture.elevation_limit_rad());
}

std::vector<float> solid_angles_of(const GpuEchoes::Setting& setting) {
  const std::vector<double>& edges = setting.aperture.beam_edges_rad;
  std::vector<float> angles;
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    angles.push_back(static_cast<float>(height_of(setting) * (edges[beam] - edges[beam + 1])));
  }
  return angles;
}

/// Units per steradian, a power of two, so that no beam can have more than most_units.
float units_of(const GpuEchoes::Setting& setting) {
  const std::vector<double>& edges = setting.aperture.beam_edges_rad;
  double widest = 0;
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    widest = std::max(widest, edges[beam] - edges[beam + 1]);
  }
  const double most_echo = static_cast<double>(setting.options.largest_response) * widest * 2 *
                           std::sin(setting.aperture.elevation_limit_rad());
  return static_cast<float>(std::exp2(std::floor(std::log2(most_units / most_echo))));
}

EchoRecord echo_record_of(const GpuEchoes::Setting& setting, const ElevationPattern& pattern) {
  constexpr float anything = 1e30F;
  const auto& [aperture, range, surface, accuracy, options] = setting;
  const auto line_m = static_cast<float>(range.step_m);
  const auto tan_limit = static_cast<float>(std::tan(aperture.elevation_limit_rad()));
  EchoRecord record{};
  record.line_m = line_m;
  record.lines_per_m = split_in_three(1.0 / range.step_m);
  record.lines = range.count;
  record.is_physical = surface.model == Model::physical ? 1 : 0;
  record.facets_anywhere = surface.facets == Facets::everywhere ? 1 : 0;
  record.displaced_m = accuracy.linearity * line_m;
  record.mapped_m = accuracy.mapped_lines * line_m;
  record.facet_slopes = accuracy.facet_slopes;
  record.facet_m = accuracy.facet_lines * line_m;
  record.height = pattern.varies() ? slices::height_in_many_lines(accuracy.linearity) * tan_limit : anything;
  record.height_in_one_place = pattern.varies() ? slices::height_in_one_place * tan_limit : anything;
  record.sigmoid_slope = static_cast<float>(surface.sigmoid_slope);
  record.sigmoid_centre = static_cast<float>(surface.sigmoid_centre);
  record.attenuation_per_m = static_cast<float>(surface.attenuation_per_m);
  record.units_per_sr = units_of(setting);
  record.sr_per_unit = 1.0F / record.units_per_sr;
  record.is_mean = options.mean ? 1 : 0;
  record.has_open_water = options.open_water ? 1 : 0;
  if (!pattern.flat()) {
    record.has_pattern = 1;
    record.pattern_at_0 = pattern.step_at_0();
    record.pattern_per_t = pattern.steps_per_t();
    std::copy_n(pattern.table(), ElevationPattern::steps + 1, record.pattern.begin());
  }
  return record;
}

std::size_t beams_of(const GpuEchoes::Setting& setting) {
  return static_cast<std::size_t>(setting.aperture.beam_count());
}

std::size_t bins_of(const GpuEchoes::Setting& setting) {
  return beams_of(setting) * static_cast<std::size_t>(setting.range.count);
}

bool weighs(const BinningOptions& options) {
  return options.mean || options.open_water;
}

}  // namespace

struct GpuEchoes::Impl {
  const Compute& compute;
  std::map<std::string, osg::ref_ptr<osg::Program>> programs;  ///< by name and macros, built when first used
  GpuSurfaces surfaces;
  // The pattern of the last ping; it takes as long as a narrow ping.
  Aperture patterned;  ///< the aperture without beams
  std::optional<ElevationPattern> pattern;

  explicit Impl(const Compute& on) : compute(on), surfaces(on.gl()) {}

  const osg::ref_ptr<osg::Program>& program(const std::string& name, const std::string& defines,
                                            const std::string& text) {
    osg::ref_ptr<osg::Program>& program = programs[name + defines];
    if (!program) {
      program = compute.build(name, text.c_str(), defines);
    }
    return program;
  }

  void run(const osg::ref_ptr<osg::Program>& program, const PingBuffers& ping, Compute::Buffers buffers,
           std::size_t groups) const {
    compute.use(program, {&ping.ping, &ping.echo}, buffers);
    compute.dispatch(groups);
  }

  void find_pattern(const Setting& setting);
  void upload(PingBuffers& ping, const std::vector<PartSurface>& placed, const Setting& setting);
  void hold(PingBuffers& ping, const Setting& setting) const;
};

GpuEchoes::GpuEchoes(const Compute& compute) : impl_(std::make_unique<Impl>(compute)) {}
GpuEchoes::~GpuEchoes() = default;

void GpuEchoes::hold_surfaces(const std::vector<PartSurface>& surfaces, std::size_t version,
                              const std::vector<bool>& may_be_seen) {
  impl_->surfaces.hold(surfaces, version, may_be_seen);
}

const GpuSurfaces& GpuEchoes::surfaces() const {
  return impl_->surfaces;
}

void GpuEchoes::Impl::find_pattern(const Setting& setting) {
  Aperture aperture = setting.aperture;
  aperture.beam_edges_rad.clear();
  if (!pattern || aperture != patterned) {
    pattern.emplace(aperture, !setting.options.skip.on(SkipRule::flat_elevation));
    patterned = std::move(aperture);
  }
}

void GpuEchoes::Impl::upload(PingBuffers& ping, const std::vector<PartSurface>& placed,
                             const Setting& setting) {
  find_pattern(setting);
  surfaces.upload(placed, ping.surfaces);
  ping.solid_angles.fill(solid_angles_of(setting), GL_STREAM_DRAW);
  ping.echo.fill(std::vector<EchoRecord>{echo_record_of(setting, *pattern)}, GL_STREAM_DRAW);
}

void GpuEchoes::Impl::hold(PingBuffers& ping, const Setting& setting) const {
  const std::size_t bins = bins_of(setting);
  const std::size_t profiles = weighs(setting.options) ? 2 : 1;
  const std::size_t bytes_of_sums = bins * profiles * 2 * sizeof(std::uint64_t);
  ping.pieces.hold(ping.room.pieces * bytes_of_piece);
  ping.pieces_of_slices.hold(ping.room.slices * bytes_of_slice_pieces);
  ping.image.hold(bins * profiles * sizeof(float));
  ping.sums.hold(bytes_of_sums);
  ping.sums.clear(bytes_of_sums, {0, 0});
}

void GpuEchoes::make(PingBuffers& ping, const std::vector<PartSurface>& placed, const Setting& setting) {
  Impl& on = *impl_;
  on.upload(ping, placed, setting);
  on.hold(ping, setting);
  const bool has_facets = setting.surface.facets == Facets::everywhere ||
                          (setting.surface.facets == Facets::near_normal && on.surfaces.any_facets());
  const std::string of_world = fmt::format("#define SHADED {:d}\n#define MAPPED {:d}\n#define FACETS {:d}\n",
                                           on.surfaces.any_shaded(), on.surfaces.any_mapped(), has_facets);
  const std::string weighed = fmt::format("#define WEIGHED {:d}\n", weighs(setting.options));
  using namespace shaders;
  const std::string shading = std::string(patches_glsl) + facets_glsl + echoes_glsl + pieces_glsl;
  const std::string summing = std::string(whole_numbers_glsl) + echoes_glsl;
  const Compute::Buffers of_pieces = {&ping.slices,   &ping.visible,       &ping.pieces_of_slices,
                                      &ping.surfaces, &ping.fan,           &ping.counts,
                                      &ping.pieces,   &on.surfaces.world()};
  on.run(on.program("pieces.comp", of_world, shading + pieces_comp), ping, of_pieces, ping.room.slices);
  const char* const maps = on.surfaces.any_mapped() ? normal_maps_glsl : "";
  on.run(on.program("patches.comp", of_world, shading + maps + patches_comp), ping, of_pieces,
         ping.room.slices);
  on.run(on.program("bin.comp", weighed, summing + bin_comp), ping,
         {&ping.slices, &ping.pieces_of_slices, &ping.counts, &ping.pieces, &ping.sums}, ping.room.slices);
  on.run(on.program("sums.comp", weighed, summing + sums_comp), ping,
         {&ping.solid_angles, &ping.counts, &ping.image, &ping.sums}, beams_of(setting));
  on.compute.gl().glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  const std::size_t bins = bins_of(setting);
  ping.result.ask({{ping.counts, sizeof(PingCounts)},
                   {ping.image, bins * (setting.options.open_water ? 2 : 1) * sizeof(float)}});
}

std::optional<BinningResult> GpuEchoes::take(PingBuffers& ping, const Setting& setting,
                                             std::vector<float> memory) const {
  BinningResult result;
  result.echo = std::move(memory);
  result.beams = setting.aperture.beam_count();
  result.lines = setting.range.count;
  result.echo.resize(bins_of(setting));
  result.open_sr.resize(setting.options.open_water ? result.echo.size() : 0);
  PingCounts counts{};
  const bool got = ping.result.wait([&](std::span<const std::byte> bytes) {
    const std::size_t image_bytes = result.echo.size() * sizeof(float);
    std::memcpy(&counts, bytes.data(), sizeof counts);
    std::memcpy(result.echo.data(), &bytes[sizeof counts], image_bytes);
    if (setting.options.open_water) {
      std::memcpy(result.open_sr.data(), &bytes[sizeof counts + image_bytes], image_bytes);
    }
  });
  if (!got) {
    throw RendererError("the OpenGL context is lost");
  }
  ping.counted = counts;
  if (!ping.room.fits(counts)) {
    ping.room.grow(counts);
    return std::nullopt;
  }
  result.samples = counts.samples;
  result.invalid_samples = counts.invalid;
  if (setting.options.skip.on(SkipRule::empty_beams) && !setting.options.open_water) {
    result.skipped.add(SkipRule::empty_beams, counts.empty_beams);
  }
  result.skipped.add(SkipRule::facet_kernel,
                     setting.surface.facets == Facets::near_normal ? counts.without_facets : 0);
  return result;
}

}  // namespace sonard::render
