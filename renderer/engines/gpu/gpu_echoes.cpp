// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_echoes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

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

double height_of(const GpuPing& ping) {
  return ping.options.open_water ? ping.settings.aperture.pattern_height()
                                 : 2 * std::sin(ping.settings.aperture.elevation_limit_rad());
}

std::vector<float> solid_angles_of(const GpuPing& ping) {
  const std::vector<double>& edges = ping.settings.aperture.beam_edges_rad;
  std::vector<float> angles;
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    angles.push_back(static_cast<float>(height_of(ping) * (edges[beam] - edges[beam + 1])));
  }
  return angles;
}

/// Units per steradian, a power of two, so that no beam can have more than most_units.
float units_of(const GpuPing& ping) {
  const std::vector<double>& edges = ping.settings.aperture.beam_edges_rad;
  double widest = 0;
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    widest = std::max(widest, edges[beam] - edges[beam + 1]);
  }
  const double most_echo = static_cast<double>(ping.options.largest_response) * widest * 2 *
                           std::sin(ping.settings.aperture.elevation_limit_rad());
  return static_cast<float>(std::exp2(std::floor(std::log2(most_units / most_echo))));
}

records::Echo record_of(const GpuPing& ping, const ElevationPattern& pattern) {
  constexpr float anything = 1e30F;
  const RangeBins& range = ping.settings.range;
  const auto line_m = static_cast<float>(range.step_m);
  const auto tan_limit = static_cast<float>(std::tan(ping.settings.aperture.elevation_limit_rad()));
  records::Echo record{};
  record.line_m = line_m;
  const auto [lines_per_m_0, lines_per_m_1, lines_per_m_2] = split_in_three(1.0 / range.step_m);
  record.lines_per_m_0 = lines_per_m_0;
  record.lines_per_m_1 = lines_per_m_1;
  record.lines_per_m_2 = lines_per_m_2;
  record.lines = range.count;
  record.is_physical = ping.surface.model == Model::physical ? 1 : 0;
  record.facets_anywhere = ping.surface.facets == Facets::everywhere ? 1 : 0;
  record.displaced_m = ping.accuracy.linearity * line_m;
  record.mapped_m = ping.accuracy.mapped_lines * line_m;
  record.facet_slopes = ping.accuracy.facet_slopes;
  record.facet_m = ping.accuracy.facet_lines * line_m;
  record.height =
      pattern.varies() ? slices::height_in_many_lines(ping.accuracy.linearity) * tan_limit : anything;
  record.height_in_one_place = pattern.varies() ? slices::height_in_one_place * tan_limit : anything;
  record.sigmoid_slope = static_cast<float>(ping.surface.sigmoid_slope);
  record.sigmoid_centre = static_cast<float>(ping.surface.sigmoid_centre);
  record.attenuation_per_m = static_cast<float>(ping.surface.attenuation_per_m);
  record.units_per_sr = units_of(ping);
  record.sr_per_unit = 1.0F / record.units_per_sr;
  record.is_mean = ping.options.mean ? 1 : 0;
  record.has_open_water = ping.options.open_water ? 1 : 0;
  if (!pattern.flat()) {
    record.has_pattern = 1;
    record.pattern_at_0 = pattern.step_at_0();
    record.pattern_per_t = pattern.steps_per_t();
    std::copy_n(pattern.table(), ElevationPattern::steps + 1, record.pattern);
  }
  return record;
}

std::size_t beams_of(const GpuPing& ping) {
  return static_cast<std::size_t>(ping.settings.aperture.beam_count());
}

std::size_t bins_of(const GpuPing& ping) {
  return beams_of(ping) * static_cast<std::size_t>(ping.settings.range.count);
}

bool weighs(const BinningOptions& options) {
  return options.mean || options.open_water;
}

}  // namespace

const osg::ref_ptr<osg::Program>& GpuEchoes::program(const std::string& name, const char* text,
                                                     const std::string& defines) {
  osg::ref_ptr<osg::Program>& program = programs_[name + defines];
  if (!program) {
    program = compute_.build(name, text, defines);
  }
  return program;
}

const ElevationPattern& GpuEchoes::pattern_of(const GpuPing& ping) {
  Aperture aperture = ping.settings.aperture;
  aperture.beam_edges_rad.clear();
  if (!pattern_ || aperture != patterned_) {
    pattern_.emplace(aperture, !ping.options.skip.on(SkipRule::flat_elevation));
    patterned_ = std::move(aperture);
  }
  return *pattern_;
}

void GpuEchoes::make(PingBuffers& in, const std::vector<PartSurface>& placed, const GpuPing& ping) {
  const std::size_t bins = bins_of(ping), profiles = weighs(ping.options) ? 2 : 1;
  const std::size_t bytes_of_sums = bins * profiles * 2 * sizeof(std::uint64_t);
  surfaces_.upload(placed, in.surfaces);
  in.solid_angles.fill(solid_angles_of(ping), GL_STREAM_DRAW);
  in.echo.fill(std::vector{record_of(ping, pattern_of(ping))}, GL_STREAM_DRAW);
  in.pieces.hold(in.room.pieces * sizeof(records::Patch));
  in.pieces_of_slices.hold(in.room.slices * sizeof(records::SlicePieces));
  in.image.hold(bins * profiles * sizeof(float));
  in.sums.hold(bytes_of_sums);
  in.sums.clear(bytes_of_sums);
  const bool has_facets = ping.surface.facets == Facets::everywhere ||
                          (ping.surface.facets == Facets::near_normal && surfaces_.any_facets());
  const std::string of_world = fmt::format("#define SHADED {:d}\n#define MAPPED {:d}\n#define FACETS {:d}\n",
                                           surfaces_.any_shaded(), surfaces_.any_mapped(), has_facets);
  const std::string weighed = fmt::format("#define WEIGHED {:d}\n", profiles - 1);
  using namespace shaders;
  const Compute::Buffers blocks = {&in.ping, &in.echo},
                         of_pieces = {&in.slices, &in.visible, &in.pieces_of_slices, &in.surfaces,
                                      &in.fan,    &in.counts,  &in.pieces,           &surfaces_.world()};
  compute_.run(program("pieces.comp", pieces_comp, of_world), blocks, of_pieces, in.room.slices);
  compute_.run(program("patches.comp", patches_comp, of_world), blocks, of_pieces, in.room.slices);
  compute_.run(program("bin.comp", bin_comp, weighed), blocks,
               {&in.slices, &in.pieces_of_slices, &in.counts, &in.pieces, &in.sums}, in.room.slices);
  compute_.run(program("sums.comp", sums_comp, weighed), blocks,
               {&in.solid_angles, &in.counts, &in.image, &in.sums}, beams_of(ping));
  compute_.gl().glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  in.result.ask({{in.counts, sizeof(PingCounts)},
                 {in.image, bins * (ping.options.open_water ? 2 : 1) * sizeof(float)}});
}

std::optional<BinningResult> GpuEchoes::take(PingBuffers& in, const GpuPing& ping,
                                             std::vector<float> memory) {
  BinningResult result;
  result.echo = std::move(memory);
  result.beams = ping.settings.aperture.beam_count();
  result.lines = ping.settings.range.count;
  result.echo.resize(bins_of(ping));
  result.open_sr.resize(ping.options.open_water ? result.echo.size() : 0);
  PingCounts counts{};
  const bool got = in.result.wait([&](std::span<const std::byte> bytes) {
    const std::size_t image_bytes = result.echo.size() * sizeof(float);
    std::memcpy(&counts, bytes.data(), sizeof counts);
    std::memcpy(result.echo.data(), &bytes[sizeof counts], image_bytes);
    if (ping.options.open_water) {
      std::memcpy(result.open_sr.data(), &bytes[sizeof counts + image_bytes], image_bytes);
    }
  });
  if (!got) {
    throw RendererError("the OpenGL context is lost");
  }
  in.counted = counts;
  if (in.grow(counts.needed)) {
    return std::nullopt;
  }
  result.samples = counts.samples;
  result.invalid_samples = counts.invalid;
  if (ping.options.skip.on(SkipRule::empty_beams) && !ping.options.open_water) {
    result.skipped.add(SkipRule::empty_beams, counts.empty_beams);
  }
  result.skipped.add(SkipRule::facet_kernel,
                     ping.surface.facets == Facets::near_normal ? counts.without_facets : 0);
  return result;
}

}  // namespace sonard::render
