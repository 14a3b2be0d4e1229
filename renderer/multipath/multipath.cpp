// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/multipath.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/binning/range_profile.hpp"

namespace sonard::render {

namespace {

constexpr double fast_coarseness = 2.0;       // of the cells with the preset `fast`
constexpr double small_parts_in_cells = 2.0;  // size in cell diagonals up to which a grid may miss a part
constexpr int search_rays = 8;                // along each side of such a part

Mirror water_surface_of(const MultipathSettings& settings) {
  return {-1.0, settings.water_surface_rms_height_m};
}

bool is_finite(const EchoPatch& patch) {
  return std::isfinite(patch.range_a_m + patch.range_b_m + patch.smear_a_m + patch.smear_b_m + patch.echo);
}

void add(const EchoPatch& patch, double step_m, RangeProfile& profile) {
  const double a = static_cast<double>(patch.range_a_m) / step_m;
  const double b = static_cast<double>(patch.range_b_m) / step_m;
  if (a == b) {  // the echo of a corner reflector is in one line, even at a border of two
    profile.add_point(a, patch.echo);
    return;
  }
  const auto lines_per_m = static_cast<float>(1.0 / step_m);
  profile.add(a, patch.smear_a_m * lines_per_m, b, patch.smear_b_m * lines_per_m, patch.echo, 0.0F);
}

}  // namespace

Multipath::Multipath(SpatialIndex& index, WorkerPool& workers, const SkipSwitches& skip)
    : world_(index.world()),
      workers_(workers),
      skip_(skip),
      survey_(world_),
      scene_(index),
      ghosts_(workers),
      bounces_(world_, workers) {}

bool Multipath::is_needed(const MultipathSettings& settings, double max_range_m,
                          const Pose& T_world_sonar) const {
  const glm::dvec3& at = T_world_sonar.position_m;
  return (world_.water_surface_z_m &&
          water_surface_mirrors(water_surface_of(settings), *world_.water_surface_z_m - at.z, max_range_m,
                                settings.wavelength_m)) ||
         (settings.level == MultipathSettings::Level::full &&
          survey_.has_mirror(world_, at, max_range_m, settings.wavelength_m));
}

void Multipath::add_to(std::vector<float>& echo, const SonarSettings& settings, const Pose& T_world_sonar,
                       SkipCounts& skipped) {
  const MultipathSettings& multipath = settings.physical.multipath;
  if (settings.model != Model::physical || multipath.level == MultipathSettings::Level::off) {
    return;
  }
  const double max_range_m = settings.range.max_range_m();
  const glm::dvec3& at_m = T_world_sonar.position_m;
  const bool full = multipath.level == MultipathSettings::Level::full;
  const bool may_skip = skip_.on(SkipRule::multipath);
  const bool mirrors = !may_skip || is_needed(multipath, max_range_m, T_world_sonar);
  const bool may_bounce = full && multipath.most_bounces > 1;
  const bool bounces =
      may_bounce && (!skip_.on(SkipRule::bounces) || bounces_.any_in_range(world_, at_m, max_range_m));
  if (!mirrors) {
    skipped.add(SkipRule::multipath);
  }
  if (may_bounce && !bounces) {
    skipped.add(SkipRule::bounces);
  }
  if (!mirrors && !bounces) {
    return;
  }
  scene_.place(at_m, water_surface_of(multipath));
  prepare(settings);
  const PathLimits limits{multipath.wavelength_m, max_range_m, may_skip ? least_mirror_gain : 0.0, full};
  if (mirrors) {
    collect(settings, T_world_sonar, limits);
  }
  if (bounces) {
    collect_bounces(settings, T_world_sonar, limits);
  }
  sum(settings.range, echo);
}

void Multipath::prepare(const SonarSettings& settings) {
  const double coarseness = settings.sampling.preset == Sampling::Preset::fast ? fast_coarseness : 1.0;
  if (!fan_ || fan_->aperture() != settings.aperture || fan_->coarseness() != coarseness) {
    fan_ = std::make_unique<PathFan>(settings.aperture, coarseness);
  }
  patches_of_beam_.resize(static_cast<std::size_t>(settings.aperture.beam_count()));
  for (std::vector<EchoPatch>& patches : patches_of_beam_) {
    patches.clear();
  }
}

void Multipath::collect_bounces(const SonarSettings& settings, const Pose& T_world_sonar,
                                const PathLimits& limits) {
  for (const std::vector<BeamPatch>& group :
       bounces_.follow(scene_, *fan_, T_world_sonar, limits, settings.physical.multipath)) {
    for (const BeamPatch& echo : group) {
      if (is_finite(echo.patch)) {
        patches_of_beam_[static_cast<std::size_t>(echo.beam)].push_back(echo.patch);
      }
    }
  }
}

void Multipath::collect(const SonarSettings& settings, const Pose& T_world_sonar, const PathLimits& limits) {
  const std::vector<GhostPaths::Result>& results = ghosts_.follow(scene_, *fan_, T_world_sonar, limits);
  for (const GhostPaths::Result& block : results) {
    for (const BeamPatch& ghost : block.patches) {
      if (is_finite(ghost.patch)) {
        patches_of_beam_[static_cast<std::size_t>(ghost.beam)].push_back(ghost.patch);
      }
    }
  }
  if (limits.meshes_mirror) {
    const GhostPaths::Result of_small_parts = search_small_parts(T_world_sonar, limits);
    collect_corners(distinct_corners(results, of_small_parts, limits), settings, T_world_sonar, limits);
  }
}

/// Aims rays at small parts, because a distant corner reflector is smaller than a cell of the fan.
GhostPaths::Result Multipath::search_small_parts(const Pose& T_world_sonar, const PathLimits& limits) const {
  const glm::dquat R_sonar_world = glm::conjugate(T_world_sonar.orientation);
  std::vector<FanCell> cells;
  for (const MirrorSurvey::Ball& ball :
       survey_.small_parts(world_, T_world_sonar.position_m, limits.max_range_m,
                           small_parts_in_cells * fan_->diagonal_rad())) {
    const glm::dvec3 p = R_sonar_world * ball.centre_m;
    if (!fan_->contains(p)) {
      continue;
    }
    const double elevation_rad = std::atan2(p.z, std::hypot(p.x, p.y));
    const double height_rad = 2 * ball.radius_m / glm::length(p);
    const FanCell around{0, std::atan2(p.y, p.x), elevation_rad, height_rad / std::cos(elevation_rad),
                         height_rad};
    for (int i = 0; i < search_rays * search_rays; ++i) {
      cells.push_back(around.part(i % search_rays, i / search_rays, search_rays, search_rays));
    }
  }
  return GhostPaths::search(scene_, *fan_, T_world_sonar, limits, cells);
}

void Multipath::collect_corners(const std::vector<CornerCandidate>& corners, const SonarSettings& settings,
                                const Pose& T_world_sonar, const PathLimits& limits) {
  std::vector<CornerReflector> reflectors(corners.size());
  workers_.run(static_cast<int>(corners.size()), [&](int i) {
    reflectors[static_cast<std::size_t>(i)] =
        corner_reflector(scene_, corners[static_cast<std::size_t>(i)], limits);
  });
  const glm::dquat R_sonar_world = glm::conjugate(T_world_sonar.orientation);
  for (const CornerReflector& reflector : reflectors) {
    const glm::dvec3 p = R_sonar_world * reflector.position_m;
    const double range_m = glm::length(p);
    if (!(reflector.intensity > 0) || !fan_->contains(p)) {
      continue;
    }
    EchoPatch patch;
    patch.range_a_m = patch.range_b_m = static_cast<float>(range_m);
    patch.echo = static_cast<float>(reflector.intensity * range_m * range_m *
                                    settings.aperture.elevation_weight(std::asin(p.z / range_m)));
    patches_of_beam_[static_cast<std::size_t>(*fan_->beam_of(std::atan2(p.y, p.x)))].push_back(patch);
  }
}

/// Sums are exact (RangeProfile), so they do not depend on the order of patches or on threads.
void Multipath::sum(const RangeBins& range, std::vector<float>& echo) {
  const auto lines = static_cast<std::size_t>(range.count);
  workers_.run(static_cast<int>(patches_of_beam_.size()), [&](int beam) {
    const std::vector<EchoPatch>& patches = patches_of_beam_[static_cast<std::size_t>(beam)];
    if (patches.empty()) {
      return;
    }
    double all = 0.0;
    for (const EchoPatch& patch : patches) {
      all += static_cast<double>(patch.echo);
    }
    thread_local RangeProfile profile;
    thread_local std::vector<float> sums;
    profile.reset(lines, all);
    for (const EchoPatch& patch : patches) {
      add(patch, range.step_m, profile);
    }
    profile.finish();
    sums.resize(lines);
    profile.read(sums.data());
    float* to = &echo[static_cast<std::size_t>(beam) * lines];
    for (std::size_t k = 0; k < lines; ++k) {
      to[k] += sums[k];
    }
  });
}

}  // namespace sonard::render
