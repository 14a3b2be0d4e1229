// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_slices.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

using records::most_slices_of_beam;
using records::side_probes;

struct CountsRecord {
  PingCounts counts{};
  records::Round rounds[records::most_rounds]{};
};

constexpr int segments_at_a_time = 960;  // of a slice; they fit in 32 KiB, which every OpenGL has
constexpr int room_for_waiting = 64;

constexpr std::size_t groups_to_fill = 1024;  // of lists.comp, enough to occupy any GPU

constexpr GLenum written_by_gpu = GL_DYNAMIC_COPY;  // so that drivers keep it in video memory

float narrow(double number) {
  return static_cast<float>(number);
}

records::Ping record_of(const GpuPing& of) {
  const Fan& fan = of.fan;
  const SliceAccuracy& accuracy = of.accuracy;
  records::Ping ping{};
  ping.fan = fan.space();
  ping.tan_limit = fan.tan_limit();
  ping.widest_slice_rad = fan.widest_slice_rad();
  ping.upright_rad = fan.upright_rad();
  ping.port_rad = narrow(fan.edge_rad(0));
  ping.starboard_rad = narrow(fan.edge_rad(fan.beam_count()));
  ping.up_x = of.bend.up.x;
  ping.up_y = of.bend.up.y;
  ping.up_z = of.bend.up.z;
  ping.bend_per_m = of.bend.per_m;
  ping.division = {accuracy.most_divisions, accuracy.most_divisions_of_lone_echoes, accuracy.disagreement,
                   accuracy.shift_lines};
  ping.line_m = narrow(of.settings.range.step_m);
  ping.bins_end_m = narrow(of.settings.range.max_range_m());
  ping.sagitta_lines = accuracy.sagitta_lines;
  ping.beams = fan.beam_count();
  ping.two_sided = of.surface.two_sided ? 1 : 0;
  ping.cull = of.options.skip.on(SkipRule::culled_clusters) ? 1 : 0;
  std::ranges::copy(of.weights, ping.weights);
  return ping;
}

std::vector<records::Beam> beams_of(const Fan& fan) {
  std::vector<records::Beam> beams(static_cast<std::size_t>(fan.beam_count()) + 1);
  for (int number = 0; number <= fan.beam_count(); ++number) {
    records::Beam& beam = beams[static_cast<std::size_t>(number)];
    const double port = fan.edge_rad(number);
    beam.port_rad = narrow(port);
    if (number < fan.beam_count()) {
      const double width = port - fan.edge_rad(number + 1), middle = port - width / 2;
      beam.middle_rad = narrow(middle);
      beam.width_rad = narrow(width);
      beam.cosine = narrow(std::cos(middle));
      beam.sine = narrow(std::sin(middle));
    }
  }
  return beams;
}

/// The first slices of a ping, and counts them in its beams.
/// @throws RequestError if there are more than the shaders can count
std::vector<GpuSlice> slices_of(const GpuPing& ping, std::vector<records::Beam>& beams) {
  const Fan& fan = ping.fan;
  const auto line_m = static_cast<double>(narrow(ping.settings.range.step_m));
  std::vector<GpuSlice> all;
  for (const FirstSlice& first : first_slices(fan, line_m, ping.accuracy)) {
    records::Beam& beam = beams[static_cast<std::size_t>(first.beam)];
    beam.first_slice = beam.slices == 0 ? static_cast<std::uint32_t>(all.size()) : beam.first_slice;
    if (++beam.slices > most_slices_of_beam || all.size() == records::most_groups) {
      throw RequestError(
          fmt::format("this fan needs more than {} slices in beam {}, or {} in all: choose engine: cpu",
                      most_slices_of_beam, first.beam + 1, records::most_groups));
    }
    const double middle = (fan.edge_rad(first.beam) + fan.edge_rad(first.beam + 1)) / 2;
    GpuSlice& slice = all.emplace_back();
    slice.cosine = narrow(std::cos(first.azimuth_rad));
    slice.sine = narrow(std::sin(first.azimuth_rad));
    slice.width_rad = narrow(first.width_rad);
    slice.beam = first.beam;
    slice.offset_rad = narrow(first.azimuth_rad - middle);
  }
  return all;
}

CountsRecord counts_of(const std::vector<GpuSlice>& slices) {
  CountsRecord record;
  record.counts.needed.slices = static_cast<std::uint32_t>(slices.size());
  record.counts.rounds = 1;
  for (records::Round& round : record.rounds) {
    round.one = round.also_one = 1;
  }
  record.rounds[0].slices = record.counts.needed.slices;
  record.rounds[0].groups = std::min(record.counts.needed.slices, records::most_groups);
  return record;
}

void hold(PingBuffers& ping) {
  const records::Room& room = ping.room;
  ping.fan.hold(room.triangles * sizeof(GpuTriangle));
  ping.lists.hold(room.entries * sizeof(std::uint32_t));
  ping.visible.hold(room.visible * sizeof(GpuVisible));
  ping.scratch.hold(room.scratch * sizeof(records::Seen));
  ping.slices.hold(room.slices * sizeof(GpuSlice));
  ping.sides.hold(room.slices * (2 * side_probes * sizeof(float)));
  ping.things.hold(room.things * sizeof(records::Thing));
  ping.ends.hold(room.things * (2 * sizeof(records::ThingEnd)));
  ping.edges.hold(room.edges * sizeof(records::Edge));
}

// Of the shaders that have one group for each beam. Lists of a wide beam are long, and llvmpipe bounds the
// loops of an invocation (loops_are_cut() in ping.glsl).
constexpr int group_of_beam = 64;

std::string see_defines(int segments) {
  return fmt::format("#define ROOM {}\n#define WAITING {}\n", segments > 0 ? segments : segments_at_a_time,
                     room_for_waiting);
}

}  // namespace

GpuSlices::GpuSlices(EglContext& context, const GpuOptions& options)
    : compute_(context, options.group, options.time_stages),
      meshes_(compute_.gl(), options.memory_mib << 20U),
      place_(compute_.build("place.comp", shaders::place_comp)),
      scan_(compute_.build("lists.comp", shaders::lists_comp, "#define SCAN 1\n")),
      fill_(compute_.build("lists.comp", shaders::lists_comp, "#define SCAN 0\n")),
      list_things_(compute_.build("things.comp", shaders::things_comp, "", group_of_beam)),
      see_(compute_.build("see.comp", shaders::see_comp, see_defines(options.segments))),
      refine_(compute_.build("refine.comp", shaders::refine_comp, "", group_of_beam)) {}

std::vector<bool> GpuSlices::may_be_seen(const std::vector<PlacedPart>& parts, const GpuPing& ping) {
  std::vector<bool> may;
  for (const PlacedPart& part : parts) {
    may.push_back(!ping.options.skip.on(SkipRule::culled_clusters) || !part.misses(ping.fan, ping.bend));
  }
  return may;
}

/// Uploads the parts that the fan may see.
/// @return number of their clusters
std::size_t GpuSlices::upload_parts(PingBuffers& in, const std::vector<PlacedPart>& placed,
                                    const GpuPing& ping) {
  const std::vector<bool> seen =
      ping.may_be_seen.empty() ? std::vector<bool>(placed.size(), true) : ping.may_be_seen;
  std::vector<std::shared_ptr<const MeshClusters>> needed;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (seen[i]) {
      needed.push_back(placed[i].clusters);
    }
  }
  meshes_.hold(needed, ping.surface_bytes);
  const bool may_hide = ping.bend.straight() && ping.options.skip.on(SkipRule::hidden_faces);
  std::vector<records::Part> parts;
  std::vector<float> hides;
  std::size_t clusters = 0;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const PlacedPart& from = placed[i];
    records::Part& part = parts.emplace_back();
    part.placement = from.placement();
    part.first_hiding = static_cast<std::uint32_t>(hides.size());
    part.first_group = static_cast<std::uint32_t>(clusters);
    if (seen[i]) {
      part.first_cluster = meshes_.first_cluster(from.clusters);
      clusters += from.clusters->clusters.size();
    }
    from.append_hiding(may_hide, hides);
  }
  hides.push_back(0.0F);  // a buffer must not be empty
  in.parts.fill(parts, written_by_gpu);
  in.hiding.fill(hides, GL_STREAM_DRAW);
  return clusters;
}

void GpuSlices::find(PingBuffers& in, const std::vector<PlacedPart>& parts, const GpuPing& ping,
                     const std::vector<GpuSlice>& slices) {
  const std::size_t clusters = upload_parts(in, parts, ping);
  std::vector<records::Beam> beams = beams_of(ping.fan);
  const std::vector<GpuSlice> chosen = slices_of(ping, beams), &first = slices.empty() ? chosen : slices;
  in.room.slices = std::max(in.room.slices, static_cast<std::uint32_t>(first.size()));
  hold(in);
  in.beams.fill(beams, written_by_gpu);
  in.order.hold(2 * beams.size() * (most_slices_of_beam + 1) * sizeof(std::uint32_t));
  in.counts.fill(std::vector{counts_of(first)}, written_by_gpu);
  in.slices.write(first);
  records::Ping record = record_of(ping);
  record.room = in.room;
  record.clusters = static_cast<std::int32_t>(clusters);
  record.parts = static_cast<std::int32_t>(parts.size());
  in.ping.fill(std::vector{record}, GL_STREAM_DRAW);
  compute_.run(place_, {&in.ping},
               {&meshes_.vertices(), &meshes_.triangles(), &meshes_.clusters(), &in.parts, &in.fan,
                &in.counts, &in.beams, &in.hiding},
               clusters);
  compute_.run(scan_, {&in.ping}, {&in.lists, &in.fan, &in.counts, &in.beams}, 1);
  compute_.run(fill_, {&in.ping}, {&in.lists, &in.fan, &in.counts, &in.beams}, groups_to_fill);
  compute_.run(list_things_, {&in.ping},
               {&in.parts, &in.things, &in.edges, &in.lists, &in.fan, &in.counts, &in.beams, &in.ends},
               beams.size() - 1);
}

void GpuSlices::see(PingBuffers& in, const GpuPing& ping, int rounds) const {
  const int most = ping.accuracy.most_divisions > 1 ? rounds : 1;
  for (int round = 0; round < most; ++round) {
    compute_.use(
        see_, {&in.ping},
        {&in.slices, &in.visible, &in.scratch, &in.lists, &in.fan, &in.counts, &in.beams, &in.sides});
    compute_.gl().glUniform1i(0, round);
    compute_.dispatch_indirect(in.counts,
                               sizeof(PingCounts) + static_cast<std::size_t>(round) * sizeof(records::Round));
    if (round + 1 < most) {
      compute_.use(
          refine_, {&in.ping},
          {&in.slices, &in.order, &in.sides, &in.things, &in.edges, &in.counts, &in.beams, &in.ends});
      compute_.gl().glUniform1i(0, round);
      compute_.dispatch(static_cast<std::size_t>(ping.fan.beam_count()));
    }
  }
}

}  // namespace sonard::render
