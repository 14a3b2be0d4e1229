// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_slices.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <osg/Program>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_meshes.hpp"
#include "renderer/engines/gpu/shaders.hpp"
#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/errors.hpp"

namespace sonard::render {

namespace {

// Records of the shaders. In the layouts std140 and std430, numbers of four bytes lie one behind the other.

struct PingRecord {
  float tan_limit, sin_limit, cos_limit, max_range_m;
  float port_x, port_y, starboard_x, starboard_y;
  float port_rad, starboard_rad, upright_rad, widest_slice_rad;
  float up_x, up_y, up_z, bend_per_m;
  std::int32_t beams, clusters, parts;
  std::int32_t is_convex;
  std::int32_t two_sided, cull;
  std::int32_t most_triangles, most_entries, most_visible, most_scratch, most_slices, most_pieces,
      most_things, most_edges, padding[2];  // std140: blocks are padded to 16 bytes
};

struct PartRecord {
  slices::Placement placement;
  std::uint32_t first_hiding, is_tall, first_cluster, first_group;
};

struct BeamRecord {
  float port_rad = 0.0F;
  std::uint32_t count = 0, begin = 0, filled = 0;
  float middle_rad = 0.0F, width_rad = 0.0F;
  float cosine = 1.0F, sine = 0.0F;
  std::uint32_t first_thing = 0, things = 0, ends = 0, first_edge = 0, edges = 0;
  std::uint32_t first_slice = 0, slices = 0;
  float port_mismatch = 0.0F, port_curvature = 0.0F, port_shift_lines = 0.0F;
};

struct ThingRecord {
  float low_azimuth, high_azimuth, low_t, high_t;
  std::uint32_t key;
};

struct EndRecord {
  float azimuth;
  std::uint32_t key, is_high;
};

struct EdgeRecord {
  float offset_rad;
  std::uint32_t count;
  std::uint32_t probes[slices::side_probes / 32];
};

struct RoundRecord {
  std::uint32_t groups = 0, one = 1, also_one = 1;
  std::uint32_t first_slice = 0, slices = 0;
};
constexpr std::size_t most_slices_of_beam = 1023;

struct CountsRecord {
  PingCounts counts{};
  RoundRecord rounds[GpuSlices::most_rounds];
};

struct RefinementRecord {
  std::int32_t slices_per_beam, most_divisions, most_divisions_of_lone_echoes, first_in_five;
  float disagreement, shift_lines, padding[2];  // std140: structures are padded to 16 bytes
  float line_m, max_range_m, sagitta_lines, more_padding;
  ProbeWeights weights;
};

// What see.comp keeps of a visible segment until the segments are in order.
constexpr std::size_t bytes_of_scratch = 16;

constexpr int room_for_waiting = 64;

constexpr std::size_t groups_to_fill = 1024;  // of lists.comp, enough to occupy any GPU

constexpr GLenum written_by_gpu = GL_DYNAMIC_COPY;  // so that drivers keep it in video memory

std::int32_t as_int(std::size_t number) {
  return static_cast<std::int32_t>(number);
}

}  // namespace

struct GpuSlices::Impl {
  Compute compute;
  osg::ref_ptr<osg::Program> place, scan, fill, list_things, look, compare;
  GpuMeshes meshes;

  Impl(EglContext& context, const Options& options)
      : compute(context, options.group), meshes(compute.gl(), options.memory_mib << 20U) {
    if (options.time_stages) {
      compute.time_stages();
    }
    place = compute.build("place.comp", shaders::place_comp);
    scan = compute.build("lists.comp", shaders::lists_comp, "#define SCAN 1\n");
    fill = compute.build("lists.comp", shaders::lists_comp, "#define SCAN 0\n");
    list_things = compute.build("things.comp", shaders::things_comp);
    compare = compute.build("refine.comp", shaders::refine_comp);
    look = compute.build(
        "see.comp", shaders::see_comp,
        fmt::format("#define ROOM {}\n#define WAITING {}\n", options.segments, room_for_waiting));
  }

  static PingRecord record_of(const PingBuffers& of_ping, const PingSetting& setting, std::size_t clusters,
                              std::size_t parts) {
    const Fan& fan_of_ping = setting.fan;
    const double port = fan_of_ping.edge_rad(0), starboard = fan_of_ping.edge_rad(fan_of_ping.beam_count());
    const double limit = std::atan(static_cast<double>(fan_of_ping.tan_limit()));
    const auto narrow = [](double number) { return static_cast<float>(number); };
    return {fan_of_ping.tan_limit(),
            narrow(std::sin(limit)),
            narrow(std::cos(limit)),
            fan_of_ping.max_range_m(),
            narrow(-std::sin(port)),
            narrow(std::cos(port)),
            narrow(std::sin(starboard)),
            narrow(-std::cos(starboard)),
            narrow(port),
            narrow(starboard),
            fan_of_ping.upright_rad(),
            fan_of_ping.widest_slice_rad(),
            setting.bend.up.x,
            setting.bend.up.y,
            setting.bend.up.z,
            setting.bend.per_m,
            fan_of_ping.beam_count(),
            as_int(clusters),
            as_int(parts),
            narrow(port - starboard) < slices::half_turn ? 1 : 0,
            setting.two_sided ? 1 : 0,
            setting.skip.on(SkipRule::culled_clusters) ? 1 : 0,
            as_int(of_ping.room.triangles),
            as_int(of_ping.room.entries),
            as_int(of_ping.room.visible),
            as_int(of_ping.room.scratch),
            as_int(of_ping.room.slices),
            as_int(of_ping.room.pieces),
            as_int(of_ping.room.things),
            as_int(of_ping.room.edges),
            {}};
  }

  static void hold(PingBuffers& of_ping) {
    const PingBuffers::Room& room = of_ping.room;
    of_ping.fan.hold(room.triangles * sizeof(GpuTriangle));
    of_ping.lists.hold(room.entries * sizeof(std::uint32_t));
    of_ping.visible.hold(room.visible * sizeof(GpuVisible));
    of_ping.scratch.hold(room.scratch * bytes_of_scratch);
    of_ping.slices.hold(room.slices * sizeof(GpuSlice));
    of_ping.sides.hold(room.slices * 2 * slices::side_probes * sizeof(float));
    of_ping.things.hold(room.things * sizeof(ThingRecord));
    of_ping.ends.hold(2 * room.things * sizeof(EndRecord));
    of_ping.edges.hold(room.edges * sizeof(EdgeRecord));
  }

  /// Uploads the parts that the fan may see.
  /// @return number of their clusters
  std::size_t upload_parts(PingBuffers& of_ping, const std::vector<PlacedPart>& placed,
                           const PingSetting& setting) {
    const std::vector<bool> seen =
        setting.may_be_seen.empty() ? std::vector<bool>(placed.size(), true) : setting.may_be_seen;
    std::vector<std::shared_ptr<const MeshClusters>> needed;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      if (seen[i]) {
        needed.push_back(placed[i].clusters);
      }
    }
    meshes.hold(needed, setting.surface_bytes);
    const bool may_hide = setting.bend.straight() && setting.skip.on(SkipRule::hidden_faces);
    std::vector<PartRecord> records;
    std::vector<float> hides;
    std::size_t clusters = 0;
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const PlacedPart& part = placed[i];
      PartRecord record{part.placement(), static_cast<std::uint32_t>(hides.size()), 0, 0,
                        static_cast<std::uint32_t>(clusters)};
      if (seen[i]) {
        record.first_cluster = meshes.first_cluster(part.clusters);
        clusters += part.clusters->clusters.size();
      }
      records.push_back(record);
      part.append_hiding(may_hide, hides);
    }
    hides.push_back(0.0F);  // a buffer must not be empty
    of_ping.parts.fill(records, written_by_gpu);
    of_ping.hiding.fill(hides, GL_STREAM_DRAW);
    return clusters;
  }

  /// @return the first slices of the ping
  /// @throws RequestError if there are more than the shaders can count
  static std::vector<GpuSlice> upload_beams(PingBuffers& of_ping, const PingSetting& setting) {
    const Fan& fan = setting.fan;
    std::vector<BeamRecord> records(static_cast<std::size_t>(fan.beam_count()) + 1);
    for (int beam = 0; beam <= fan.beam_count(); ++beam) {
      BeamRecord& record = records[static_cast<std::size_t>(beam)];
      const double port = fan.edge_rad(beam);
      record.port_rad = static_cast<float>(port);
      if (beam < fan.beam_count()) {
        const double width = port - fan.edge_rad(beam + 1), middle = port - width / 2;
        record.middle_rad = static_cast<float>(middle);
        record.width_rad = static_cast<float>(width);
        record.cosine = static_cast<float>(std::cos(middle));
        record.sine = static_cast<float>(std::sin(middle));
      }
    }
    std::vector<GpuSlice> first;
    for (const FirstSlice& slice : first_slices(fan, static_cast<double>(setting.line_m), setting.accuracy)) {
      BeamRecord& record = records[static_cast<std::size_t>(slice.beam)];
      record.first_slice = record.slices == 0 ? static_cast<std::uint32_t>(first.size()) : record.first_slice;
      if (++record.slices > most_slices_of_beam || first.size() == most_groups) {
        throw RequestError(
            fmt::format("this fan needs more than {} slices in beam {}, or {} in all: choose engine: cpu",
                        most_slices_of_beam, slice.beam + 1, most_groups));
      }
      const double middle = (fan.edge_rad(slice.beam) + fan.edge_rad(slice.beam + 1)) / 2;
      GpuSlice made;
      made.cosine = static_cast<float>(std::cos(slice.azimuth_rad));
      made.sine = static_cast<float>(std::sin(slice.azimuth_rad));
      made.width_rad = static_cast<float>(slice.width_rad);
      made.beam = slice.beam;
      made.offset_rad = static_cast<float>(slice.azimuth_rad - middle);
      first.push_back(made);
    }
    of_ping.beams.fill(records, written_by_gpu);
    of_ping.order.hold(2 * records.size() * (most_slices_of_beam + 1) * sizeof(std::uint32_t));
    return first;
  }

  static RefinementRecord refinement_of(const PingSetting& setting) {
    const SliceAccuracy& accuracy = setting.accuracy;
    return {accuracy.slices_per_beam,
            accuracy.most_divisions,
            accuracy.most_divisions_of_lone_echoes,
            accuracy.first_in_five ? 1 : 0,
            accuracy.disagreement,
            accuracy.shift_lines,
            {},
            setting.line_m,
            setting.max_range_m,
            accuracy.sagitta_lines,
            0.0F,
            setting.weights};
  }

  void run_list_things(const PingBuffers& p, const PingSetting& setting) const {
    compute.use(list_things, {&p.ping},
                {&p.parts, &p.things, &p.edges, &p.lists, &p.fan, &p.counts, &p.beams, &p.ends});
    compute.dispatch(static_cast<std::size_t>(setting.fan.beam_count()));
  }

  static void upload_slices(PingBuffers& of_ping, const std::vector<GpuSlice>& slices) {
    CountsRecord record;
    record.counts.slices = static_cast<std::uint32_t>(slices.size());
    record.counts.rounds = 1;
    record.rounds[0].slices = record.counts.slices;
    record.rounds[0].groups = std::min(record.counts.slices, static_cast<std::uint32_t>(most_groups));
    of_ping.counts.fill(std::vector<CountsRecord>{record}, written_by_gpu);
    of_ping.room.slices = std::max(of_ping.room.slices, slices.size());
    hold(of_ping);
    of_ping.slices.write(slices);
  }

  void run_see(const PingBuffers& p, int round) const {
    compute.use(look, {&p.ping, nullptr, &p.refinement},
                {&p.slices, &p.visible, &p.scratch, &p.lists, &p.fan, &p.counts, &p.beams, &p.sides});
    compute.gl().glUniform1i(0, round);
    compute.dispatch_indirect(p.counts,
                              sizeof(PingCounts) + static_cast<std::size_t>(round) * sizeof(RoundRecord));
  }

  void run_refine(const PingBuffers& p, int round, const PingSetting& setting) const {
    compute.use(compare, {&p.ping, nullptr, &p.refinement},
                {&p.slices, &p.order, &p.sides, &p.things, &p.edges, &p.counts, &p.beams, &p.ends});
    compute.gl().glUniform1i(0, round);
    compute.dispatch(static_cast<std::size_t>(setting.fan.beam_count()));
  }
};

GpuSlices::GpuSlices(EglContext& context) : GpuSlices(context, Options()) {}
GpuSlices::GpuSlices(EglContext& context, const Options& options)
    : impl_(std::make_unique<Impl>(context, options)) {}
GpuSlices::~GpuSlices() = default;

std::vector<bool> GpuSlices::may_be_seen(const std::vector<PlacedPart>& parts, const PingSetting& setting) {
  std::vector<bool> may;
  for (const PlacedPart& part : parts) {
    may.push_back(!setting.skip.on(SkipRule::culled_clusters) || !part.misses(setting.fan, setting.bend));
  }
  return may;
}

void GpuSlices::find(PingBuffers& ping, const std::vector<PlacedPart>& parts, const PingSetting& setting,
                     const std::vector<GpuSlice>& slices) {
  Impl& on = *impl_;
  const std::size_t clusters = on.upload_parts(ping, parts, setting);
  const std::vector<GpuSlice> first = Impl::upload_beams(ping, setting);
  Impl::upload_slices(ping, slices.empty() ? first : slices);
  ping.ping.fill(std::vector<PingRecord>{Impl::record_of(ping, setting, clusters, parts.size())},
                 GL_STREAM_DRAW);
  ping.refinement.fill(std::vector<RefinementRecord>{Impl::refinement_of(setting)}, GL_STREAM_DRAW);
  on.compute.use(on.place, {&ping.ping},
                 {&on.meshes.vertices(), &on.meshes.triangles(), &on.meshes.clusters(), &ping.parts,
                  &ping.fan, &ping.counts, &ping.beams, &ping.hiding});
  on.compute.dispatch(clusters);
  const Compute::Buffers of_lists = {&ping.lists, &ping.fan, &ping.counts, &ping.beams};
  on.compute.use(on.scan, {&ping.ping}, of_lists);
  on.compute.dispatch(1);
  on.compute.use(on.fill, {&ping.ping}, of_lists);
  on.compute.dispatch(groups_to_fill);
  on.run_list_things(ping, setting);
}

void GpuSlices::see(PingBuffers& ping, const PingSetting& setting, int rounds) const {
  const int most = setting.accuracy.most_divisions > 1 ? rounds : 1;
  for (int round = 0; round < most; ++round) {
    impl_->run_see(ping, round);
    if (round + 1 < most) {
      impl_->run_refine(ping, round, setting);
    }
  }
}

const GpuMeshes& GpuSlices::meshes() const {
  return impl_->meshes;
}

const Compute& GpuSlices::compute() const {
  return impl_->compute;
}

}  // namespace sonard::render
