// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/gpu_slices.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>
#include <string>

#include <fmt/format.h>
#include <osg/GLExtensions>
#include <osg/Program>
#include <osg/State>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gl_errors.hpp"
#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"
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
  std::int32_t beams, clusters;
  std::int32_t is_convex;
  std::int32_t two_sided, cull;
  std::int32_t most_triangles, most_entries, most_visible, most_scratch;
};

struct TriangleRecord {
  std::uint32_t corners, mesh_triangle, shell;
};

struct ClusterRecord {
  float x, y, z, radius_m;
  std::uint32_t part, first_vertex, vertex_count, first_triangle, triangle_count;
};

struct PartRecord {
  slices::Placement placement;
  std::uint32_t first_hiding, is_tall;
};

struct BeamRecord {
  float port_rad;
  std::uint32_t count, begin, filled;
};

// What see.comp keeps of a visible segment until the segments are in order.
constexpr std::size_t bytes_of_scratch = 16;

constexpr int room_for_waiting = 64;

enum Binding : unsigned {  // as in the shaders
  vertices_at = 0,
  triangles_at = 1,
  clusters_at = 2,
  parts_at = 3,
  fan_at = 4,
  counts_at = 5,
  beams_at = 6,
  hiding_at = 7,
  slices_at = 0,
  visible_at = 1,
  scratch_at = 2,
  lists_at = 3,
  sides_at = 7,
};

std::int32_t as_int(std::size_t number) {
  return static_cast<std::int32_t>(number);
}

}  // namespace

struct GpuSlices::Impl {
  /// Room in the buffers of a ping, in records.
  struct Room {
    std::size_t triangles = 1U << 14, entries = 1U << 16, visible = 1U << 16, scratch = 1U << 18;
  };

  EglContext& context;
  osg::GLExtensions& gl;
  const int group;  ///< invocations of a group that sees a slice
  osg::ref_ptr<osg::Program> place, scan, fill, see;
  // Of the world:
  GpuBuffer vertices, mesh_triangles, clusters;
  std::size_t cluster_count = 0;
  // Of a ping:
  GpuBuffer ping, parts, hiding, fan, counts, beams, lists, slices, visible, scratch, sides;
  Room room;
  std::size_t slice_count = 0;

  Impl(EglContext& made_current, const Options& options)
      : context(made_current),
        gl(*osg::GLExtensions::Get(context.getState()->getContextID(), true)),
        group(options.group > 0    ? options.group
              : context.software() ? 8
                                   : 64),
        vertices(gl),
        mesh_triangles(gl),
        clusters(gl),
        ping(gl),
        parts(gl),
        hiding(gl),
        fan(gl),
        counts(gl),
        beams(gl),
        lists(gl),
        slices(gl),
        visible(gl),
        scratch(gl),
        sides(gl) {
    place = build("place.comp", shaders::place_comp, "");
    scan = build("lists.comp", shaders::lists_comp, "#define SCAN 1\n");
    fill = build("lists.comp", shaders::lists_comp, "#define SCAN 0\n");
    see = build("see.comp", shaders::see_comp,
                fmt::format("#define ROOM {}\n#define WAITING {}\n", options.segments, room_for_waiting));
  }

  osg::ref_ptr<osg::Program> build(const std::string& name, const char* text, const std::string& defines) {
    std::string source = fmt::format("#version 430\n#define GROUP {}u\n", group) + defines;
    for (const char* common : {shaders::language_glsl, shaders::cut_glsl, shaders::place_glsl,
                               shaders::sweep_glsl, shaders::sides_glsl, shaders::ping_glsl}) {
      source += common;
    }
    return context.build_program({new osg::Shader(osg::Shader::COMPUTE, source + text)}, name);
  }

  void use(const osg::ref_ptr<osg::Program>& program) {
    program->getPCP(*context.getState())->useProgram();
    gl.glBindBufferBase(GL_UNIFORM_BUFFER, 0, ping.name());
  }

  void dispatch(std::size_t groups) {
    const std::size_t rows = (groups + most_groups - 1) / most_groups;
    if (groups > 0) {
      gl.glDispatchCompute(static_cast<GLuint>((groups + rows - 1) / rows), static_cast<GLuint>(rows), 1);
    }
    gl.glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  }

  template <class T>
  std::vector<T> read(const GpuBuffer& buffer, std::size_t count) {
    gl.glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    GpuReadback readback(gl);
    readback.ask({{buffer, count * sizeof(T)}});
    std::vector<T> values(count);
    if (!readback.wait([&](std::span<const std::byte> bytes) {
          std::memcpy(values.data(), bytes.data(), bytes.size());
        })) {
      throw RendererError("the OpenGL context is lost");
    }
    check_gl_errors("seeing slices");
    return values;
  }

  /// Gives each buffer the room that the last ping needed.
  void make_room(const Counts& needed) {
    const auto grow = [](std::size_t& has, std::size_t needs) {
      if (needs > has) {
        has = needs + needs / 4;
      }
    };
    grow(room.triangles, needed.triangles);
    grow(room.entries, needed.entries);
    grow(room.visible, needed.visible);
    grow(room.scratch, needed.scratch);
  }

  bool had_room(const Counts& needed) const {
    return needed.triangles <= room.triangles && needed.entries <= room.entries &&
           needed.visible <= room.visible && needed.scratch <= room.scratch;
  }

  PingRecord record_of(const PingSetting& setting) const {
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
            as_int(cluster_count),
            narrow(port - starboard) < slices::half_turn ? 1 : 0,
            setting.two_sided ? 1 : 0,
            setting.skip.on(SkipRule::culled_clusters) ? 1 : 0,
            as_int(room.triangles),
            as_int(room.entries),
            as_int(room.visible),
            as_int(room.scratch)};
  }

  void hold_ping() {
    fan.hold(room.triangles * sizeof(Triangle));
    lists.hold(room.entries * sizeof(std::uint32_t));
    visible.hold(room.visible * sizeof(Visible));
    scratch.hold(room.scratch * bytes_of_scratch);
  }

  void upload_parts(const std::vector<PlacedPart>& placed, const PingSetting& setting) {
    const bool may_hide = setting.bend.straight() && setting.skip.on(SkipRule::hidden_faces);
    std::vector<PartRecord> records;
    std::vector<float> hides;
    for (const PlacedPart& part : placed) {
      records.push_back({part.placement(), static_cast<std::uint32_t>(hides.size()), 0});
      part.append_hiding(may_hide, hides);
    }
    hides.push_back(0.0F);  // a buffer must not be empty
    parts.fill(records, GL_STREAM_DRAW);
    hiding.fill(hides, GL_STREAM_DRAW);
  }

  void upload_beams(const Fan& fan_of_ping) {
    std::vector<BeamRecord> records;
    for (int beam = 0; beam <= fan_of_ping.beam_count(); ++beam) {
      records.push_back({static_cast<float>(fan_of_ping.edge_rad(beam)), 0, 0, 0});
    }
    beams.fill(records, GL_STREAM_DRAW);
  }
};

GpuSlices::GpuSlices(EglContext& context) : GpuSlices(context, Options()) {}
GpuSlices::GpuSlices(EglContext& context, const Options& options)
    : impl_(std::make_unique<Impl>(context, options)) {}
GpuSlices::~GpuSlices() = default;

void GpuSlices::set_parts(const std::vector<PlacedPart>& parts) {
  std::vector<float> vertices;
  std::vector<TriangleRecord> triangles;
  std::vector<ClusterRecord> clusters;
  struct Begin {
    std::uint32_t vertex, triangle;
  };
  std::vector<std::pair<const MeshClusters*, Begin>> uploaded;  // meshes that parts share are uploaded once
  for (std::uint32_t p = 0; p < parts.size(); ++p) {
    const MeshClusters& mesh = *parts[p].clusters;
    auto known = std::ranges::find(uploaded, &mesh, [](const auto& entry) { return entry.first; });
    if (known == uploaded.end()) {
      const Begin begin{static_cast<std::uint32_t>(vertices.size() / 3),
                        static_cast<std::uint32_t>(triangles.size())};
      known = uploaded.insert(uploaded.end(), {&mesh, begin});
      for (std::size_t v = 0; v < mesh.x.size(); ++v) {
        vertices.insert(vertices.end(), {mesh.x[v], mesh.y[v], mesh.z[v]});
      }
      for (std::size_t t = 0; t < mesh.mesh_triangle.size(); ++t) {
        const std::uint32_t corners = mesh.corners[0][t] | std::uint32_t{mesh.corners[1][t]} << 8U |
                                      std::uint32_t{mesh.corners[2][t]} << 16U;
        triangles.push_back({corners, mesh.mesh_triangle[t], mesh.shell[t]});
      }
    }
    const Begin begin = known->second;
    for (const MeshClusters::Cluster& c : mesh.clusters) {
      clusters.push_back({c.centre_m.x, c.centre_m.y, c.centre_m.z, c.radius_m, p,
                          begin.vertex + c.first_vertex, c.vertex_count, begin.triangle + c.first_triangle,
                          c.triangle_count});
    }
  }
  impl_->cluster_count = clusters.size();
  impl_->vertices.fill(vertices);
  impl_->mesh_triangles.fill(triangles);
  impl_->clusters.fill(clusters);
}

void GpuSlices::find(const std::vector<PlacedPart>& parts, const PingSetting& setting) {
  Impl& on = *impl_;
  on.hold_ping();
  on.upload_parts(parts, setting);
  on.upload_beams(setting.fan);
  on.counts.fill(std::vector<Counts>(1), GL_STREAM_DRAW);
  on.ping.fill(std::vector<PingRecord>{on.record_of(setting)}, GL_STREAM_DRAW);
  on.use(on.place);
  on.vertices.bind(vertices_at);
  on.mesh_triangles.bind(triangles_at);
  on.clusters.bind(clusters_at);
  on.parts.bind(parts_at);
  on.fan.bind(fan_at);
  on.counts.bind(counts_at);
  on.beams.bind(beams_at);
  on.hiding.bind(hiding_at);
  on.dispatch(on.cluster_count);
  on.lists.bind(lists_at);
  on.use(on.scan);
  on.dispatch(1);
  on.use(on.fill);
  on.dispatch((on.room.triangles + static_cast<std::size_t>(on.group) - 1) /
              static_cast<std::size_t>(on.group));
}

std::vector<GpuSlices::Slice> GpuSlices::see(const std::vector<Slice>& slices) {
  Impl& on = *impl_;
  on.slice_count = slices.size();
  on.slices.fill(slices, GL_STREAM_DRAW);
  on.sides.hold(slices.size() * 2 * slices::side_probes * sizeof(float));
  on.use(on.see);
  on.slices.bind(slices_at);
  on.visible.bind(visible_at);
  on.scratch.bind(scratch_at);
  on.lists.bind(lists_at);
  on.fan.bind(fan_at);
  on.counts.bind(counts_at);
  on.beams.bind(beams_at);
  on.sides.bind(sides_at);
  on.gl.glUniform1ui(0, static_cast<GLuint>(slices.size()));
  on.dispatch(slices.size());
  const Counts needed = counts();
  if (!on.had_room(needed)) {
    on.make_room(needed);
    return {};
  }
  return on.read<Slice>(on.slices, slices.size());
}

GpuSlices::Counts GpuSlices::counts() {
  return impl_->read<Counts>(impl_->counts, 1)[0];
}

std::vector<GpuSlices::Triangle> GpuSlices::triangles() {
  return impl_->read<Triangle>(impl_->fan, std::min<std::size_t>(counts().triangles, impl_->room.triangles));
}

std::vector<GpuSlices::Visible> GpuSlices::visible() {
  return impl_->read<Visible>(impl_->visible, std::min<std::size_t>(counts().visible, impl_->room.visible));
}

std::vector<float> GpuSlices::sides() {
  return impl_->read<float>(impl_->sides, impl_->slice_count * 2 * slices::side_probes);
}

}  // namespace sonard::render
