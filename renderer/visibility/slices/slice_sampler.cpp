#include "renderer/visibility/slices/slice_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/simd.hpp"
#include "renderer/visibility/slices/slice_shading.hpp"

namespace sonard::render {

namespace {

constexpr double widest_first_slice_rad = std::numbers::pi / 180;
constexpr int divisions_at_once = 4;
constexpr double most_sag_lines = 0.06;  // at `change` 1 %

/// How wide a first slice may be around an azimuth. Along a wall across the axis the range is d / cos psi and
/// the echo goes as cos^3 psi: within a slice the echo must not change, and the range not depart from a
/// straight line, by more than the accuracy allows.
double widest_first_slice(double azimuth_rad, double line_m, double max_range_m, double change) {
  const double tangent = std::abs(std::tan(std::min(std::abs(azimuth_rad), 1.4)));
  const double for_echo = change * std::sqrt(12.0) / (3 * tangent + 1e-9);
  const double sag_m = most_sag_lines * line_m * (change / 0.01);
  const double for_range = std::sqrt(8 * sag_m / (max_range_m * (1 + 2 * tangent * tangent)));
  return std::min({widest_first_slice_rad, for_echo, std::max(for_range, for_echo / 4)});
}

}  // namespace

/// What stays the same during one ping.
struct SliceSampler::Setting {
  Fan fan;
  ElevationPattern pattern;
  const SurfaceModel& surface;
  const SliceAccuracy& accuracy;
  const FanTriangles& triangles;
  const std::vector<PartSurface>& parts;
  bool any_mapped;
  float line_m;
};

/// Memory of one thread.
struct SliceSampler::Scratch {
  SliceCutter cutter;
  Segments segments;
  SliceSweep sweep;
  SlicePatcher patcher;
};

SliceSampler::SliceSampler(const World& world, WorkerPool& workers, const SkipSwitches& skip)
    : workers_(workers), skip_(skip) {
  std::map<const TriangleMesh*, std::shared_ptr<const MeshClusters>> clusters;  // meshes are shared by parts
  std::map<const NormalMap*, std::shared_ptr<const NormalPyramid>> pyramids;
  for (const Body& body : world.bodies) {
    body_number_[body.name] = T_world_body_.size();
    for (const BodyPart& part : body.parts) {
      auto& mesh_clusters = clusters[part.mesh.get()];
      if (!mesh_clusters) {
        mesh_clusters = std::make_shared<const MeshClusters>(*part.mesh);
      }
      PartSurface surface;
      surface.mesh = part.mesh;
      surface.vertex_normals = !(skip.on(SkipRule::geometric_normals) && has_plain_facets(*part.mesh));
      skipped_parts_.add(SkipRule::geometric_normals, surface.vertex_normals ? 0 : 1);
      surface.lambert_mu = static_cast<float>(part.material.lambert_mu);
      surface.reflectance = static_cast<float>(part.material.reflectance);
      const bool can_be_mapped =
          !part.mesh->normals.empty() && !part.mesh->tangents.empty() && !part.mesh->texcoords.empty();
      if (!part.normal_map && skip.on(SkipRule::absent_normal_map)) {
        skipped_parts_.add(SkipRule::absent_normal_map);
      } else if (can_be_mapped) {
        auto& pyramid = pyramids[part.normal_map.get()];
        if (!pyramid) {
          pyramid = std::make_shared<const NormalPyramid>(part.normal_map ? NormalPyramid(*part.normal_map)
                                                                          : NormalPyramid::straight());
        }
        surface.normal_map = pyramid;
        any_mapped_ = true;
      }
      parts_.push_back({T_world_body_.size(), part.T_body_part});
      placed_.push_back({mesh_clusters, {}, {}});
      surfaces_.push_back(std::move(surface));
    }
    T_world_body_.push_back(body.T_world_body);
  }
}

bool SliceSampler::set_body_pose(const std::string& body_name, const Pose& T_world_body) {
  const auto body = body_number_.find(body_name);
  if (body == body_number_.end()) {
    return false;
  }
  T_world_body_[body->second] = T_world_body;
  return true;
}

/// In doubles up to here: no world coordinate reaches a float.
void SliceSampler::place_parts(const Pose& T_world_sonar) {
  const Pose T_sonar_world = inverse(T_world_sonar);
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const Pose T_sonar_part = T_sonar_world * T_world_body_[parts_[i].body] * parts_[i].T_body_part;
    placed_[i].R_sonar_part = glm::mat3(glm::mat3_cast(T_sonar_part.orientation));
    placed_[i].t_sonar_part_m = glm::vec3(T_sonar_part.position_m);
    surfaces_[i].R_part_sonar = glm::transpose(placed_[i].R_sonar_part);
  }
}

std::size_t SliceSampler::new_cell() {
  if (cells_used_ == cells_.size()) {
    cells_.push_back(std::make_unique<SliceCell>());
  }
  return cells_used_++;
}

void SliceSampler::lay_first_slices(const Setting& setting) {
  cells_used_ = 0;
  order_.clear();
  for (int beam = 0; beam < setting.fan.beam_count(); ++beam) {
    const double port = setting.fan.edge_rad(beam);
    const double width = port - setting.fan.edge_rad(beam + 1);
    const double widest = widest_first_slice(port - width / 2, static_cast<double>(setting.line_m),
                                             static_cast<double>(setting.fan.max_range_m()),
                                             static_cast<double>(setting.accuracy.change));
    const int count =
        std::max(setting.accuracy.slices_per_beam, static_cast<int>(std::ceil(width / widest - 1e-9)));
    for (int k = 0; k < count; ++k) {
      order_.push_back(new_cell());
      SliceCell& cell = *cells_[order_.back()];
      cell.slice = {port - width * (k + 0.5) / count, static_cast<float>(width / count)};
      cell.beam = beam;
      cell.divisions = 1;
    }
  }
}

std::vector<const SliceCell*> SliceSampler::sample(const Pose& T_world_sonar, const Aperture& aperture,
                                                   double line_m, double max_range_m,
                                                   const SurfaceModel& surface,
                                                   const SliceAccuracy& accuracy) {
  place_parts(T_world_sonar);
  const Setting setting{Fan(aperture, max_range_m),
                        ElevationPattern(aperture, !skip_.on(SkipRule::flat_elevation)),
                        surface,
                        accuracy,
                        triangles_,
                        surfaces_,
                        any_mapped_,
                        static_cast<float>(line_m)};
  triangles_.find(placed_, setting.fan, workers_, skip_.on(SkipRule::culled_clusters));
  lay_first_slices(setting);
  std::vector<std::size_t> fresh = order_;
  statistics_ = {};
  do {
    see(setting, fresh);
    statistics_.slices += fresh.size();
  } while (refine(setting, fresh));
  std::vector<const SliceCell*> cells;
  for (const std::size_t i : order_) {
    cells.push_back(cells_[i].get());
    statistics_.patches += cells.back()->patches.size();
  }
  statistics_.clusters = triangles_.clusters_tested();
  statistics_.clusters_culled = triangles_.clusters_culled();
  statistics_.skipped = skipped_parts_;
  statistics_.skipped.add(SkipRule::culled_clusters, statistics_.clusters_culled);
  statistics_.skipped.add(SkipRule::flat_elevation, setting.pattern.flat() ? 1 : 0);
  return cells;
}

/// Fills the cells `fresh`, which are in order; all of one beam in one job.
void SliceSampler::see(const Setting& setting, const std::vector<std::size_t>& fresh) {
  std::vector<std::size_t> begins;  // of each beam's run in `fresh`
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    if (i == 0 || cells_[fresh[i]]->beam != cells_[fresh[i - 1]]->beam) {
      begins.push_back(i);
    }
  }
  begins.push_back(fresh.size());
  workers_.run(static_cast<int>(begins.size()) - 1, [&](int job) {
    thread_local Scratch scratch;
    const auto j = static_cast<std::size_t>(job);
    scratch.cutter.load(triangles_.of_beam(cells_[fresh[begins[j]]]->beam), setting.surface.two_sided);
    for (std::size_t i = begins[j]; i < begins[j + 1]; ++i) {
      see_cell(setting, scratch, *cells_[fresh[i]]);
    }
  });
}

void SliceSampler::see_cell(const Setting& setting, Scratch& scratch, SliceCell& cell) {
  const float tan_limit = setting.fan.tan_limit();
  scratch.cutter.cut(cell.slice, tan_limit, scratch.segments);
  const std::vector<VisiblePiece>& pieces = scratch.sweep.run(scratch.segments, tan_limit);
  const SlicePatcher::Request request{cell.slice,         scratch.segments, pieces,
                                      scratch.cutter,     setting.parts,    setting.surface,
                                      setting.pattern,    tan_limit,        setting.accuracy.evenness,
                                      setting.any_mapped, setting.line_m};
  cell.patches.clear();
  scratch.patcher.make(request, cell.patches);
  cell.misses_something = scratch.cutter.misses_thin_triangle(cell.slice);
  scratch.patcher.profile(tan_limit, 0.5F * cell.slice.width_rad, cell.port);
  scratch.patcher.profile(tan_limit, -0.5F * cell.slice.width_rad, cell.starboard);
}

namespace {

/// Elevations at which two neighbours expect ranges more than `line_m` apart on the border between them.
SONARD_SIMD_CLONES
int disagreements(const SideProfile& a, const SideProfile& b, const SideProfile& secant, float line_m,
                  float furthest_m) {
  int count = 0;
  for (std::size_t i = 0; i < side_probes; ++i) {
    // Ranges are secant / w: compared without dividing, and without those that are out of range in both.
    const float difference = secant[i] * (a[i] > b[i] ? a[i] - b[i] : b[i] - a[i]);
    const float nearer = a[i] > b[i] ? a[i] : b[i];
    const bool heard = secant[i] < furthest_m * nearer;
    count += (difference > line_m * a[i] * b[i]) & heard ? 1 : 0;
  }
  return count;
}

SideProfile secants(float tan_limit) {
  SideProfile out;
  for (std::size_t i = 0; i < side_probes; ++i) {
    const float t = tan_limit * (2 * (static_cast<float>(i) + 0.5F) / side_probes - 1);
    out[i] = std::sqrt(1 + t * t);
  }
  return out;
}

}  // namespace

/// Divides the slices on both sides of every border at which they disagree too much. @return whether there
/// were any; `fresh` are the new ones.
bool SliceSampler::refine(const Setting& setting, std::vector<std::size_t>& fresh) {
  const SideProfile secant = secants(setting.fan.tan_limit());
  std::vector<std::uint8_t> divide(order_.size(), 0);
  const auto too_coarse = [&](const SliceCell& cell, float share) {
    const double beam = setting.fan.edge_rad(cell.beam) - setting.fan.edge_rad(cell.beam + 1);
    const float width = cell.slice.width_rad / static_cast<float>(beam);
    return cell.divisions < setting.accuracy.most_divisions &&
           share * width * width > setting.accuracy.disagreement;
  };
  for (std::size_t i = 0; i < order_.size(); ++i) {
    const SliceCell& cell = *cells_[order_[i]];
    if (cell.misses_something && cell.divisions < setting.accuracy.most_divisions) {
      divide[i] = 1;
    }
    if (i + 1 == order_.size()) {
      break;
    }
    const SliceCell& next = *cells_[order_[i + 1]];
    const float share = static_cast<float>(disagreements(cell.starboard, next.port, secant, setting.line_m,
                                                         setting.fan.max_range_m())) /
                        side_probes;
    divide[i] |= too_coarse(cell, share) ? 1 : 0;
    divide[i + 1] |= too_coarse(next, share) ? 1 : 0;
  }
  fresh.clear();
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < order_.size(); ++i) {
    if (divide[i] == 0) {
      order.push_back(order_[i]);
      continue;
    }
    const Slice whole = cells_[order_[i]]->slice;
    const int beam = cells_[order_[i]]->beam;
    const int divisions = cells_[order_[i]]->divisions * divisions_at_once;
    const double width = static_cast<double>(whole.width_rad);
    for (int k = 0; k < divisions_at_once; ++k) {
      const std::size_t at = k == 0 ? order_[i] : new_cell();
      SliceCell& cell = *cells_[at];
      cell.slice = {whole.azimuth_rad + width * (0.5 - (k + 0.5) / divisions_at_once),
                    whole.width_rad / divisions_at_once};
      cell.beam = beam;
      cell.divisions = divisions;
      order.push_back(at);
      fresh.push_back(at);
    }
  }
  order_.swap(order);
  return !fresh.empty();
}

}  // namespace sonard::render
