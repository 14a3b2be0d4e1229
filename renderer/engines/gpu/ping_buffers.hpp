// SPDX-License-Identifier: Apache-2.0
// The buffers of a ping on the GPU, which the stages of slices hand on, and their records as in ping.glsl. In
// the layouts std140 and std430, numbers of four bytes lie one behind the other.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "renderer/engines/gpu/gpu_buffer.hpp"
#include "renderer/engines/gpu/gpu_readback.hpp"

namespace sonard::render {

/// A slice, see SliceCell.
struct GpuSlice {
  static constexpr std::uint32_t is_seen = 1U, is_divided = 2U, no_edge = ~0U;

  float cosine = 1.0F, sine = 0.0F, width_rad = 0.0F;
  std::int32_t beam = 0;
  std::uint32_t first_visible = 0, visible_count = 0;  ///< in PingBuffers::visible
  std::uint32_t state = 0;                             ///< is_seen, is_divided
  float offset_rad = 0.0F;                             ///< azimuth, from the middle of the beam
  float ensonified = 0.0F, one_sided = 0.0F, lines = 0.0F, missed_share = 0.0F;
  float mismatch = 0.0F, curvature = 0.0F, shift_lines = 0.0F;  ///< on the border to the next slice
  std::uint32_t edge = no_edge;
};

/// A visible part of a triangle in a slice, see VisibleSegment.
struct GpuVisible {
  float low, high, w_at_0, w_slope;
  float low_slope, low_reach, high_slope, high_reach;
  float normal_h, normal_s, normal_z;
  std::uint32_t triangle;  ///< in PingBuffers::fan
};

/// A triangle in the fan, see FanTriangle.
struct GpuTriangle {
  float corners[9];
  float low_azimuth_rad, high_azimuth_rad;
  std::uint32_t flags, mesh_triangle, number, first_beam, last_beam;
};

/// More than there is room for: the ping must be repeated with more room.
struct PingCounts {
  std::uint32_t triangles, entries, visible, scratch, slices, pieces, things, edges;
  std::uint32_t culled_clusters, hidden_faces;
  std::uint32_t overflows;  ///< of lists that no room helps
  std::uint32_t longest_slice;
  std::uint32_t samples, invalid, without_facets, empty_beams;  ///< see BinningResult
  std::uint32_t segments, rounds, additions;                    ///< see GpuWork
};

/// One ping in flight. Each stage binds the buffers that its shaders use.
struct PingBuffers {
  /// In records. At first 65 MB, which is enough for most pings.
  struct Room {
    std::size_t triangles = 1U << 17, entries = 1U << 18, visible = 1U << 18, scratch = 1U << 20,
                slices = 1U << 12, pieces = 1U << 19, things = 1U << 14, edges = 1U << 11;

    bool fits(const PingCounts& needed) const {
      return needed.triangles <= triangles && needed.entries <= entries && needed.visible <= visible &&
             needed.scratch <= scratch && needed.slices <= slices && needed.pieces <= pieces &&
             needed.things <= things && needed.edges <= edges;
    }
    /// Grows to twice what a ping needed: what came after the full buffer could not be counted.
    void grow(const PingCounts& needed) {
      const auto make_room = [](std::size_t& has, std::size_t needs) { has = needs > has ? 2 * needs : has; };
      make_room(triangles, needed.triangles);
      make_room(entries, needed.entries);
      make_room(visible, needed.visible);
      make_room(scratch, needed.scratch);
      make_room(slices, needed.slices);
      make_room(pieces, needed.pieces);
      make_room(things, needed.things);
      make_room(edges, needed.edges);
    }
  };

  explicit PingBuffers(osg::GLExtensions& gl)
      : ping(gl),
        parts(gl),
        hiding(gl),
        fan(gl),
        counts(gl),
        beams(gl),
        lists(gl),
        slices(gl),
        visible(gl),
        scratch(gl),
        sides(gl),
        refinement(gl),
        things(gl),
        ends(gl),
        edges(gl),
        order(gl),
        echo(gl),
        surfaces(gl),
        solid_angles(gl),
        pieces_of_slices(gl),
        pieces(gl),
        sums(gl),
        image(gl),
        result(gl) {}

  Room room;
  GpuBuffer ping;                 ///< the uniform block
  GpuBuffer parts, hiding;        ///< poses of parts, and which of their shells hide their inner sides
  GpuBuffer fan;                  ///< GpuTriangle
  GpuBuffer counts;               ///< PingCounts, and the rounds of refinement
  GpuBuffer beams, lists;         ///< triangles of each beam
  GpuBuffer slices;               ///< GpuSlice
  GpuBuffer visible;              ///< GpuVisible, slice after slice
  GpuBuffer scratch;              ///< of see.comp
  GpuBuffer sides;                ///< of each slice, port and starboard: 1 / h at the probes
  GpuBuffer refinement;           ///< the uniform block
  GpuBuffer things, ends, edges;  ///< of each beam: see things.comp
  GpuBuffer order;                ///< slices of each beam from port to starboard, in even and odd rounds
  // Of GpuEchoes:
  GpuBuffer echo;                      ///< the uniform block
  GpuBuffer surfaces, solid_angles;    ///< of parts; of beams
  GpuBuffer pieces_of_slices, pieces;  ///< parts of visible segments, later their patches
  GpuBuffer sums, image;               ///< of bin.comp and sums.comp
  GpuReadback result;                  ///< counts and image
  PingCounts counted{};                ///< of the last GpuEchoes::take()
};

}  // namespace sonard::render
