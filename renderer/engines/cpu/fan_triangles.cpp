// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/fan_triangles.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "renderer/engines/slices/slice_math.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using slices::half_turn;

/// Vertices of one cluster in the sonar frame.
struct Corners {
  std::array<float, MeshClusters::most_vertices> x, y, z;
  std::array<float, MeshClusters::most_vertices> azimuth;
  std::array<float, MeshClusters::most_vertices> horizontal_squared;
  std::array<float, MeshClusters::most_vertices> tangent;  ///< of the elevation

  [[gnu::always_inline]] void set(std::size_t i, const slices::Corner& at) {
    const slices::Sight sight = slices::sight_of(at);
    x[i] = at.x;
    y[i] = at.y;
    z[i] = at.z;
    azimuth[i] = sight.azimuth;
    horizontal_squared[i] = sight.horizontal_squared;
    tangent[i] = sight.tangent;
  }
  slices::Corner corner(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

SONARD_SIMD_CLONES
void transform(const PlacedPart& part, const MeshClusters::Cluster& cluster, Corners& out) {
  const float* x = &part.clusters->x[cluster.first_vertex];
  const float* y = &part.clusters->y[cluster.first_vertex];
  const float* z = &part.clusters->z[cluster.first_vertex];
  const slices::Placement placement = part.placement();
  const auto count = static_cast<std::size_t>(cluster.vertex_count);
  for (std::size_t i = 0; i < count; ++i) {
    out.set(i, slices::place(placement, x[i], y[i], z[i]));
  }
}

/// Moves the vertices to their apparent positions.
void refract_corners(const Refraction& bend, std::uint32_t count, Corners& at) {
  for (std::uint32_t i = 0; i < count; ++i) {
    const glm::vec3 p = bend.point({at.x[i], at.y[i], at.z[i]});
    at.set(i, {p.x, p.y, p.z});
  }
}

/// True if a cluster is wholly outside the fan, with the bending of its rays.
bool is_out(const Fan& fan, const Refraction& bend, const PlacedPart& part,
            const MeshClusters::Cluster& cluster) {
  const glm::vec3 centre = part.R_sonar_part * cluster.centre_m + part.t_sonar_part_m;
  return bend.straight()
             ? fan.misses(centre, cluster.radius_m)
             : fan.misses(bend.point(centre), cluster.radius_m + bend.spread_m(centre, cluster.radius_m));
}

/// True if a cluster lies wholly to one side of the fan, by less than half a turn.
SONARD_SIMD_CLONES
bool lies_outside(const Fan& fan, std::uint32_t count, const Corners& at) {
  const auto port = static_cast<float>(fan.edge_rad(0)) + azimuth_error_rad;
  const auto starboard = static_cast<float>(fan.edge_rad(fan.beam_count())) - azimuth_error_rad;
  const float* __restrict azimuth = at.azimuth.data();
  std::int32_t to_port = 0, to_starboard = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const float a = azimuth[i];
    to_port += ((a > port) & (a < port + half_turn)) ? 1 : 0;
    to_starboard += ((a < starboard) & (a > starboard - half_turn)) ? 1 : 0;
  }
  const auto all = static_cast<std::int32_t>(count);
  return to_port == all || to_starboard == all;
}

/// True if a whole cluster may lie between two probes of a side.
SONARD_SIMD_CLONES
bool is_low(const Fan& fan, std::uint32_t count, const Corners& at) {
  const float most = 0.75F * slices::probe_step(fan.tan_limit());
  const float first = at.tangent[0];
  const float* __restrict tangent = at.tangent.data();
  std::int32_t beside = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    beside += std::abs(tangent[i] - first) > most ? 1 : 0;
  }
  return beside == 0;
}

/// One number per corner of the triangles of a cluster.
struct OfCorners {
  std::array<float, MeshClusters::most_triangles> a, b, c;

  void gather(const MeshClusters& mesh, const MeshClusters::Cluster& cluster,
              const std::array<float, MeshClusters::most_vertices>& of_vertex) {
    const std::uint8_t* const c0 = &mesh.corners[0][cluster.first_triangle];
    const std::uint8_t* const c1 = &mesh.corners[1][cluster.first_triangle];
    const std::uint8_t* const c2 = &mesh.corners[2][cluster.first_triangle];
    for (std::size_t t = 0; t < cluster.triangle_count; ++t) {
      a[t] = of_vertex[c0[t]];
      b[t] = of_vertex[c1[t]];
      c[t] = of_vertex[c2[t]];
    }
  }
};

/// Bounds of each triangle of a cluster, from its corners.
struct Bounds {
  OfCorners azimuth, horizontal_squared, height, tangent;
  std::array<float, MeshClusters::most_triangles> low_azimuth, high_azimuth;
  std::array<std::int32_t, MeshClusters::most_triangles> in_elevation, thin, upright;
};

SONARD_SIMD_CLONES
void bound(const Fan& fan, std::size_t count, Bounds& out) {
  const slices::FanLimits limits{fan.tan_limit(), fan.upright_rad()};
  for (std::size_t t = 0; t < count; ++t) {
    const slices::TriangleBounds bounds =
        slices::bounds_of_triangle({out.azimuth.a[t], out.horizontal_squared.a[t], out.tangent.a[t]},
                                   {out.azimuth.b[t], out.horizontal_squared.b[t], out.tangent.b[t]},
                                   {out.azimuth.c[t], out.horizontal_squared.c[t], out.tangent.c[t]},
                                   out.height.a[t], out.height.b[t], out.height.c[t], limits);
    out.in_elevation[t] = bounds.in_elevation;
    out.low_azimuth[t] = bounds.low_azimuth;
    out.high_azimuth[t] = bounds.high_azimuth;
    out.thin[t] = bounds.thin;
    out.upright[t] = bounds.upright;
  }
}

/// True if a whole cluster may lie between two slices: a stone, a plate.
bool is_small(const Fan& fan, std::size_t count, const Bounds& bounds) {
  const float low = *std::min_element(bounds.low_azimuth.begin(), bounds.low_azimuth.begin() + count);
  const float high = *std::max_element(bounds.high_azimuth.begin(), bounds.high_azimuth.begin() + count);
  return high - low < fan.widest_slice_rad();
}

}  // namespace

std::uint64_t FanTriangles::clusters_culled() const {
  std::uint64_t culled = 0;
  for (const Share& share : shares_) {
    culled += share.culled;
  }
  return culled;
}

void FanTriangles::find(const std::vector<PlacedPart>& parts, const Fan& fan, const Refraction& bend,
                        WorkerPool& workers, const SkipSwitches& skip) {
  cull_ = skip.on(SkipRule::culled_clusters);
  // Bent rays may reach a face from behind.
  find_hiding_shells(parts, bend.straight() && skip.on(SkipRule::hidden_faces));
  part_starts_.assign(1, 0);
  for (const PlacedPart& part : parts) {
    part_starts_.push_back(part_starts_.back() + static_cast<std::uint32_t>(part.clusters->clusters.size()));
  }
  cluster_count_ = part_starts_.back();
  const auto beams = static_cast<std::size_t>(fan.beam_count());
  shares_.resize(share_count);
  workers.run(share_count, [&](int job) {
    const auto j = static_cast<std::size_t>(job);
    Share& share = shares_[j];
    share.triangles.clear();
    share.beams.clear();
    share.per_beam.assign(beams, 0);
    share.tall.assign(parts.size(), 0);
    share.culled = share.hidden = 0;
    collect(parts, fan, bend, cluster_count_ * j / share_count, cluster_count_ * (j + 1) / share_count,
            share);
  });
  find_low_parts(parts.size());
  make_room_for_lists(beams);
  workers.run(share_count, [&](int job) { list(shares_[static_cast<std::size_t>(job)]); });
}

/// A part is low if all of its clusters in the fan are.
void FanTriangles::find_low_parts(std::size_t parts) {
  is_low_.assign(parts, 1);
  for (const Share& share : shares_) {
    for (std::size_t p = 0; p < parts; ++p) {
      is_low_[p] &= static_cast<std::uint8_t>(1 - share.tall[p]);
    }
  }
}

std::uint64_t FanTriangles::faces_hidden() const {
  std::uint64_t hidden = 0;
  for (const Share& share : shares_) {
    hidden += share.hidden;
  }
  return hidden;
}

/// @param may_hide false: no shell hides its inner side
void FanTriangles::find_hiding_shells(const std::vector<PlacedPart>& parts, bool may_hide) {
  hiding_.resize(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) {
    hiding_[i].clear();
    parts[i].append_hiding(may_hide, hiding_[i]);
  }
}

void FanTriangles::collect(const std::vector<PlacedPart>& parts, const Fan& fan, const Refraction& bend,
                           std::size_t begin, std::size_t end, Share& share) const {
  Corners at;
  Bounds bounds;
  std::size_t part_number = 0;
  for (std::size_t c = begin; c < end; ++c) {
    while (c >= part_starts_[part_number + 1]) {
      ++part_number;
    }
    const PlacedPart& part = parts[part_number];
    const MeshClusters::Cluster& cluster = part.clusters->clusters[c - part_starts_[part_number]];
    const bool out = is_out(fan, bend, part, cluster);
    if (out && cull_) {
      ++share.culled;
      continue;
    }
    transform(part, cluster, at);
    if (!bend.straight()) {
      refract_corners(bend, cluster.vertex_count, at);
    }
    if (lies_outside(fan, cluster.vertex_count, at) && cull_) {
      ++share.culled;
      continue;
    }
    bounds.azimuth.gather(*part.clusters, cluster, at.azimuth);
    bounds.horizontal_squared.gather(*part.clusters, cluster, at.horizontal_squared);
    bounds.height.gather(*part.clusters, cluster, at.z);
    bounds.tangent.gather(*part.clusters, cluster, at.tangent);
    bound(fan, cluster.triangle_count, bounds);
    const bool small = is_small(fan, cluster.triangle_count, bounds);
    if (!out && !is_low(fan, cluster.vertex_count, at)) {
      share.tall[part_number] = 1;
    }
    for (std::uint32_t n = 0; n < cluster.triangle_count; ++n) {
      if (bounds.in_elevation[n] == 0) {
        continue;
      }
      const std::uint32_t t = cluster.first_triangle + n;
      const std::size_t i = part.clusters->corners[0][t];
      const std::size_t j = part.clusters->corners[1][t];
      const std::size_t k = part.clusters->corners[2][t];
      const std::uint32_t shell = part.clusters->shell[t];
      // A thin face counts although it is hidden: the lid of a lying pipe shows where the pipe ends.
      if (shell != Shells::none && bounds.thin[n] == 0 &&
          slices::is_turned_away(at.corner(i), at.corner(j), at.corner(k), hiding_[part_number][shell])) {
        ++share.hidden;
        continue;
      }
      const bool whole_turn = bounds.high_azimuth[n] - bounds.low_azimuth[n] > half_turn;
      add({{at.x[i], at.x[j], at.x[k]},
           {at.y[i], at.y[j], at.y[k]},
           {at.z[i], at.z[j], at.z[k]},
           static_cast<std::uint32_t>(part_number),
           part.clusters->mesh_triangle[t],
           0,
           !out && bounds.thin[n] != 0,
           !out && small,
           !out,  // if its part is low: list()
           bounds.upright[n] != 0,
           whole_turn ? -half_turn : bounds.low_azimuth[n],
           whole_turn ? half_turn : bounds.high_azimuth[n]},
          {at.azimuth[i], at.azimuth[j], at.azimuth[k]}, fan, share);
    }
  }
}

void FanTriangles::add(const FanTriangle& triangle, const std::array<float, 3>& azimuth, const Fan& fan,
                       Share& share) {
  if (triangle.high_azimuth_rad - triangle.low_azimuth_rad <= half_turn) {
    share.add(triangle, fan.beams_between(triangle.low_azimuth_rad, triangle.high_azimuth_rad));
    return;
  }
  if (std::min({std::abs(azimuth[0]), std::abs(azimuth[1]), std::abs(azimuth[2])}) < half_turn / 2) {
    // It may contain the sonar's vertical axis: any azimuth can hit it.
    share.add(triangle, {0, fan.beam_count() - 1});
    return;
  }
  // It lies behind the sonar, across the azimuth of pi and -pi.
  float port = half_turn;
  float starboard = -half_turn;
  for (const float a : azimuth) {
    (a > 0 ? port : starboard) = a > 0 ? std::min(port, a) : std::max(starboard, a);
  }
  share.add(triangle, fan.beams_between(port, half_turn));
  share.add(triangle, fan.beams_between(-half_turn, starboard));
}

void FanTriangles::Share::add(const FanTriangle& triangle, Fan::BeamRange range) {
  if (range.first > range.last) {
    return;
  }
  triangles.push_back(triangle);
  beams.push_back(range);
  for (int b = range.first; b <= range.last; ++b) {
    ++per_beam[static_cast<std::size_t>(b)];
  }
}

/// Converts the counts of each share to the places of its triangles in listed_.
void FanTriangles::make_room_for_lists(std::size_t beams) {
  first_of_beam_.resize(beams + 1);
  std::size_t next = 0;
  for (std::size_t b = 0; b < beams; ++b) {
    first_of_beam_[b] = next;
    for (Share& share : shares_) {
      const std::uint32_t count = share.per_beam[b];
      share.per_beam[b] = static_cast<std::uint32_t>(next);
      next += count;
    }
  }
  first_of_beam_[beams] = next;
  listed_.resize(next);
  count_ = 0;
  for (Share& share : shares_) {
    share.first = count_;
    count_ += share.triangles.size();
  }
}

void FanTriangles::list(Share& share) {
  for (std::size_t i = 0; i < share.triangles.size(); ++i) {
    FanTriangle& triangle = share.triangles[i];
    triangle.number = static_cast<std::uint32_t>(share.first + i);
    triangle.low = triangle.low && is_low_[triangle.part] != 0;
    for (int b = share.beams[i].first; b <= share.beams[i].last; ++b) {
      listed_[share.per_beam[static_cast<std::size_t>(b)]++] = {&triangle, triangle.low_azimuth_rad,
                                                                triangle.high_azimuth_rad};
    }
  }
}

}  // namespace sonard::render
