// SPDX-License-Identifier: Apache-2.0
#include "server/config/head_section.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/config/head_kind.hpp"

namespace sonard::server {
namespace {

constexpr std::uint64_t max_u64 = std::numeric_limits<std::uint64_t>::max();
constexpr Range level_db = Range::from(-300.0, 300.0);

double read_noise_budget(YamlSection& section, double carrier_hz) {
  render::NoiseBudget budget;
  budget.spectral_level_db = render::thermal_noise_db(carrier_hz);
  section.number("source_level_db", budget.source_level_db, level_db);
  section.number("spectral_level_db", budget.spectral_level_db, level_db);
  section.number("directivity_db", budget.directivity_db, Range::from(0.0, 100.0));
  double bandwidth_khz = budget.bandwidth_hz / 1000.0;
  section.number("bandwidth_khz", bandwidth_khz, Range::above(0.0, 10'000.0));
  budget.bandwidth_hz = bandwidth_khz * 1000.0;
  return render::noise_level_db(budget);
}

void read_ring_down(YamlSection& section, render::RingDown& ring_down) {
  section.boolean("on", ring_down.on);
  section.number("level_db", ring_down.level_db, level_db);
  section.number("peak_m", ring_down.peak_m, Range::above(0.0, 10.0));
  section.number("end_m", ring_down.end_m, Range::above(0.0, 100.0));
  if (ring_down.end_m <= ring_down.peak_m) {
    section.report("end_m", "is not beyond peak_m (expected a larger range)");
  }
}

void read_interference(YamlSection& section, render::Interference& interference) {
  section.number("probability", interference.probability, Range::from(0.0, 1.0));
  section.number("least_db", interference.least_db, Range::from(0.0, 100.0));
  section.number("most_db", interference.most_db, Range::from(0.0, 100.0));
  if (interference.most_db < interference.least_db) {
    section.report("most_db", "is less than least_db (expected at least as much)");
  }
}

void read_multipath(YamlSection& section, render::MultipathSettings& multipath) {
  using Level = render::MultipathSettings::Level;
  section.choice("level", multipath.level,
                 {{"full", Level::full}, {"surface", Level::surface}, {"off", Level::off}});
  double rms_height_mm = multipath.water_surface_rms_height_m * 1000.0;
  section.number("water_surface_rms_height_mm", rms_height_mm, Range::from(0.0, 10'000.0));
  multipath.water_surface_rms_height_m = rms_height_mm / 1000.0;
}

void read_physical_model(YamlSection& section, double carrier_hz, render::PhysicalModel& model) {
  using Speckle = render::PhysicalModel::Speckle;
  section.choice("speckle", model.speckle,
                 {{"ou", Speckle::ou},
                  {"frozen", Speckle::frozen},
                  {"per_ping", Speckle::per_ping},
                  {"off", Speckle::off}});
  section.number("aperture_m", model.aperture_m, Range::above(0.0, 10.0));
  using Backscatter = render::PhysicalModel::Backscatter;
  section.choice("backscatter", model.backscatter,
                 {{"lambert_facet", Backscatter::lambert_facet}, {"lambert", Backscatter::lambert}});
  section.boolean("noise", model.noise);
  if (section.has("noise_budget") && section.has("noise_level_db")) {
    section.report("noise_budget", "sets noise_level_db, which is given too (expected one of the two)");
  }
  section.number("noise_level_db", model.noise_level_db, level_db);
  section.section("noise_budget",
                  [&](YamlSection& inner) { model.noise_level_db = read_noise_budget(inner, carrier_hz); });
  section.number("texture_nu", model.texture_nu, Range::from(0.0, 1000.0));
  section.number("texture_range_m", model.texture_range_m, Range::above(0.0, 1000.0));
  section.number_or_word("volume_scattering_db", model.volume_scattering_db, Range::from(-200.0, 0.0),
                         {{"off", -std::numeric_limits<double>::infinity()}});
  section.number("tvg_log_coefficient", model.tvg_log_coefficient, Range::from(0.0, 60.0));
  double tvg_absorption_db_per_km = model.tvg_absorption_db_per_m * 1000.0;
  section.number("tvg_absorption_db_per_km", tvg_absorption_db_per_km, Range::from(0.0, 10'000.0));
  model.tvg_absorption_db_per_m = tvg_absorption_db_per_km / 1000.0;
  section.number("tvg_max_db", model.tvg_max_db, Range::from(0.0, 200.0));
  section.number("gain_db", model.gain_db, level_db);
  section.number("near_field_blank_m", model.near_field_blank_m, Range::from(0.0, 120.0));
  section.number("broadside_stripe_db", model.broadside_stripe_db, Range::from(0.0, 60.0));
  section.section("ring_down", [&](YamlSection& inner) { read_ring_down(inner, model.ring_down); });
  section.section("interference", [&](YamlSection& inner) { read_interference(inner, model.interference); });
  section.section("multipath", [&](YamlSection& inner) { read_multipath(inner, model.multipath); });
  section.boolean("motion_within_ping", model.motion_within_ping);
}

void read_paper_model(YamlSection& section, render::PaperModel& model) {
  using Speckle = render::PaperModel::Speckle;
  bool later_release = false;
  section.choice("preset", later_release, {{"paper2017", false}, {"paper2018", true}});
  if (later_release) {
    model = render::PaperModel::release_2018();
  }
  section.number("sigmoid_slope", model.sigmoid_slope, Range::above(0.0, 1000.0));
  section.number("sigmoid_centre", model.sigmoid_centre, Range::from(0.0, 1.0));
  section.boolean("two_sided", model.two_sided);
  section.boolean("legacy_bin_index", model.legacy_bin_index);
  section.boolean("legacy_columns", model.legacy_columns);
  section.boolean("elevation_mask", model.elevation_mask);
  section.boolean("footprint", model.footprint);
  section.number("attenuation_per_m", model.attenuation_per_m, Range::from(0.0, 10.0));
  section.number("gain", model.gain, Range::from(0.0, 1.0));
  section.choice("speckle", model.speckle,
                 {{"gaussian", Speckle::gaussian},
                  {"folded_gaussian", Speckle::folded_gaussian},
                  {"off", Speckle::off}});
  section.number("speckle_mean", model.speckle_mean, Range::from(0.0, 10.0));
  section.number("speckle_sd", model.speckle_sd, Range::from(0.0, 10.0));
  section.number("speckle_floor", model.speckle_floor, Range::from(0.0, 1.0));
}

void read_mount(YamlSection& section, HeadConfig& head) {
  section.text("from_world", head.mount_from_world);
  read_pose(section, head.T_vehicle_sonar);
  for (const char* key : {"position_m", "rpy_deg"}) {
    if (section.has("from_world") && section.has(key)) {
      section.report(key, "the world says where the head sits (expected this or from_world)");
    }
  }
}

/// One line for all heads: they share the water, and nearly the frequency.
void warn_of_extrapolation(std::vector<ConfigWarning>& warnings) {
  const bool said = std::any_of(warnings.begin(), warnings.end(),
                                [](const ConfigWarning& warning) { return warning.key == "water"; });
  if (!said) {
    warnings.push_back(
        {"water",
         "the absorption is computed outside of what its formula was made for, -2 to 30 degrees and "
         "30 to 35 ppt: it may be off by more than 10 % (absorption_db_per_km sets it)"});
  }
}

}  // namespace

HeadConfig read_head(YamlSection& section, const HeadContext& context, std::span<const HeadKind* const> kinds,
                     std::vector<ConfigWarning>& warnings) {
  std::vector<std::pair<std::string_view, const HeadKind*>> types;
  std::vector<std::string_view> names;
  for (const HeadKind* kind : kinds) {
    types.emplace_back(kind->type(), kind);
    names.push_back(kind->type());
  }
  const HeadKind* kind = kinds.front();  // where the type is wrong the other keys are still read
  section.require("type", fmt::format("{}", fmt::join(names, " or ")));
  section.choice_of("type", kind, types);
  return kind->read(section, context, warnings);
}

void read_common(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  head.acoustics.sampling = context.sampling;
  section.require("name", "a name of this head for the log");
  section.text("name", head.name);
  section.section("mount", [&](YamlSection& inner) { read_mount(inner, head); });
  section.boolean("hides_vehicle", head.hides_vehicle);
  section.section("dump", [&](YamlSection& inner) {
    std::string directory;
    inner.require("directory", "a folder to write to");
    inner.text("directory", directory);
    head.dump_directory = context.folder / directory;
  });
}

void read_acoustics(YamlSection& section, double carrier_hz, HeadConfig& head) {
  render::SonarSettings& settings = head.acoustics;
  section.choice("mode", settings.model,
                 {{"physical", render::Model::physical}, {"paper", render::Model::paper}});
  section.integer("seed", head.seed, 0, max_u64);
  section.angle("vertical_beamwidth_deg", settings.aperture.vertical_beamwidth_rad, Range::above(0.0, 170.0));
  using Elevation = render::Aperture::Elevation;
  section.choice("elevation_pattern", settings.aperture.elevation,
                 {{"top_hat", Elevation::top_hat},
                  {"sinc", Elevation::sinc},
                  {"sinc_two_way", Elevation::sinc_two_way}});
  section.section("physical",
                  [&](YamlSection& inner) { read_physical_model(inner, carrier_hz, settings.physical); });
  section.section("paper", [&](YamlSection& inner) { read_paper_model(inner, settings.paper); });
}

void apply_water(const HeadContext& context, double carrier_hz, HeadConfig& head,
                 std::vector<ConfigWarning>& warnings) {
  const WaterConfig& w = context.water;
  const render::Water water{w.temperature_c, w.salinity_ppt, w.depth_m, w.ph};
  double absorption = context.absorption_db_per_m;
  if (absorption < 0.0) {
    absorption = render::francois_garrison_absorption_db_per_m(carrier_hz, water);
    if (!render::in_absorption_range(carrier_hz, water)) {
      warn_of_extrapolation(warnings);
    }
  }
  head.acoustics.physical.absorption_db_per_m = absorption;
  head.acoustics.physical.multipath.wavelength_m = render::sound_speed_mps(water) / carrier_hz;
  // The device's own absorption setting matches the water unless the user says otherwise.
  head.acoustics.physical.tvg_absorption_db_per_m = absorption;
}

void read_pose(YamlSection& section, render::Pose& pose) {
  constexpr double far_m = 1e8;  // beyond the radius of the earth: geocentric coordinates fit
  section.vector3("position_m", pose.position_m, Range::from(-far_m, far_m));
  glm::dvec3 rpy_deg{0.0};
  section.vector3("rpy_deg", rpy_deg, Range::from(-360.0, 360.0));
  const glm::dvec3 rpy = rpy_deg * (std::numbers::pi / 180.0);
  pose.orientation =
      glm::normalize(glm::angleAxis(rpy.z, glm::dvec3(0, 0, 1)) * glm::angleAxis(rpy.y, glm::dvec3(0, 1, 0)) *
                     glm::angleAxis(rpy.x, glm::dvec3(1, 0, 0)));
}

}  // namespace sonard::server
