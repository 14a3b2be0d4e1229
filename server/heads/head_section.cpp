// SPDX-License-Identifier: Apache-2.0
#include "server/heads/head_section.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/water.hpp"
#include "server/diagnosis/sight.hpp"
#include "server/heads/head_type.hpp"
#include "server/yaml/pose_section.hpp"

namespace sonard::server {
namespace {

constexpr std::uint64_t max_u64 = std::numeric_limits<std::uint64_t>::max();
constexpr Range level_db = Range::from(-300.0, 300.0);

double read_noise_budget(YamlSection& section, double carrier_hz) {
  section.introduce(
      "The level is `spectral_level_db` - `directivity_db` + 10 log10 of the bandwidth in Hz - "
      "`source_level_db`; by default -138.2 dB at 720 kHz.");
  render::NoiseBudget budget;
  budget.spectral_level_db = render::thermal_noise_db(carrier_hz);
  section.number("source_level_db", budget.source_level_db, level_db, "source level, dB re 1 uPa at 1 m");
  section.number(
      "spectral_level_db", budget.spectral_level_db, level_db,
      "noise spectral level, dB re 1 uPa^2/Hz; the default is thermal noise at the frequency of the head");
  section.number("directivity_db", budget.directivity_db, Range::from(0.0, 100.0),
                 "directivity index of the receive array");
  section.number("bandwidth_khz", budget.bandwidth_hz, Range::above(0.0, 10'000.0),
                 "bandwidth of the receiver", 1e-3);
  return render::noise_level_db(budget);
}

void read_ring_down(YamlSection& section, render::RingDown& ring_down) {
  section.introduce(
      "The ring-down rises from zero at half of `peak_m`, or is at its peak level from the first sample on "
      "(`from_start`). From the peak to `end_m` it falls by 80 dB.");
  section.boolean("on", ring_down.on, "true: the transducer rings after its pulse");
  section.number("level_db", ring_down.level_db, level_db,
                 "intensity of the peak re the source intensity at 1 m, before TVG");
  section.number("peak_m", ring_down.peak_m, Range::above(0.0, 10.0), "range of the peak");
  section.number("end_m", ring_down.end_m, Range::above(0.0, 100.0),
                 "range at which the ring-down ends; must be larger than `peak_m`");
  section.boolean("from_start", ring_down.from_start,
                  "true: all samples up to `peak_m` are as bright as the peak");
  section.number("sd_db", ring_down.sd_db, Range::from(0.0, 20.0),
                 "standard deviation of the level from ping to ping");
  section.number_or_word("vehicle_level_db", ring_down.vehicle_level_db, level_db,
                         {{"off", -std::numeric_limits<double>::infinity()}},
                         "level of the vehicle's echo at 1 m, before TVG");
  section.number("vehicle_fall_db_per_m", ring_down.vehicle_fall_db_per_m, Range::above(0.0, 1000.0),
                 "decay of the vehicle's own echo with range");
  if (ring_down.end_m <= ring_down.peak_m) {
    section.report("end_m", "is not beyond peak_m (expected a larger range)");
  }
}

void read_interference(YamlSection& section, render::Interference& interference) {
  section.introduce(
      "A disturbed ping contains one burst of noise. The seed draws the disturbed pings and the start and "
      "level of each burst, with uniform distributions.");
  section.number("probability", interference.probability, Range::from(0.0, 1.0),
                 "probability that a ping is disturbed");
  section.number("least_db", interference.least_db, Range::from(0.0, 100.0), "minimum rise of the noise");
  section.number("most_db", interference.most_db, Range::from(0.0, 100.0), "maximum rise of the noise");
  section.number("median_length_m", interference.median_length_m, Range::above(0.0, 1000.0),
                 "median length of a burst; lengths are between half and twice the median");
  section.number("to_the_end_probability", interference.to_the_end_probability, Range::from(0.0, 1.0),
                 "probability that a burst lasts to the end of the ping instead");
  if (interference.most_db < interference.least_db) {
    section.report("most_db", "is less than least_db (expected at least as much)");
  }
}

void read_water_clutter(YamlSection& section, render::WaterClutter& clutter) {
  section.introduce(
      "The seed draws the places of the scatterers in the world. They are visible within 20 m and before the "
      "first echo of a beam.");
  section.number("density_per_m3", clutter.density_per_m3, Range::from(0.0, 10.0),
                 "number of scatterers per cubic metre; 0: off");
  section.number("target_strength_db", clutter.target_strength_db, level_db,
                 "target strength of one scatterer (mean intensity), re 1 m");
}

void read_multipath(YamlSection& section, render::MultipathSettings& multipath) {
  section.introduce(
      "The materials of the world determine which surfaces act as mirrors ([worlds.md](worlds.md)). If no "
      "surface does, the rule `multipath` skips this work.");
  using Level = render::MultipathSettings::Level;
  section.choice("level", multipath.level,
                 {{"full", Level::full}, {"surface", Level::surface}, {"off", Level::off}},
                 "`full`: smooth surfaces mirror, two or three make corner reflectors, and rough surfaces "
                 "send sound on to one another; `surface`: only the water surface mirrors");
  section.integer("most_bounces", multipath.most_bounces, 0, 32,
                  "with level `full`: most surfaces that a path meets; below 2: no bounces");
  section.number("bounce_loss_db", multipath.bounce_loss_db, Range::from(0.0, 60.0),
                 "extra loss when a rough surface sends sound on (growth, thin plates)");
  section.number("water_surface_rms_height_mm", multipath.water_surface_rms_height_m,
                 Range::from(0.0, 10'000.0),
                 "rms height of waves and ripples on the water surface. 0 mirrors like glass; about 20 is a "
                 "light breeze and mirrors only at the flattest angles; a wind sea never mirrors",
                 1000.0);
}

void read_physical_model(YamlSection& section, double carrier_hz, bool scanning,
                         render::PhysicalModel& model) {
  using Kind = render::SpeckleSettings::Kind;
  section.choice(
      "speckle", model.speckle.kind,
      {{"ou", Kind::ou}, {"frozen", Kind::frozen}, {"per_ping", Kind::per_ping}, {"off", Kind::off}},
      "`ou`: constant at rest, decorrelates as the sonar moves; `frozen`: always the same; "
      "`per_ping`: drawn anew for each ping");
  section.number(
      "aperture_m", model.speckle.aperture_m, Range::above(0.0, 10.0),
      "length of the array; a motion by half of it, from one ping to the next, keeps 37 % of the speckle");
  using Backscatter = render::PhysicalModel::Backscatter;
  section.choice(
      "backscatter", model.backscatter,
      {{"lambert_facet", Backscatter::lambert_facet}, {"lambert", Backscatter::lambert}},
      "`lambert_facet`: materials show facets near normal incidence; `lambert`: they only scatter diffusely");
  section.boolean("noise", model.noise.on, "adds noise, which the TVG amplifies with range");
  if (section.has("noise_budget") && section.has("noise_level_db")) {
    section.report("noise_budget", "sets noise_level_db, which is given too (expected one of the two)");
  }
  section.number("noise_level_db", model.noise.level_db, level_db,
                 "noise intensity re the source intensity at 1 m, before TVG");
  section.section("noise_budget", "sonar equation for the noise, instead of `noise_level_db`",
                  [&](YamlSection& inner) { model.noise.level_db = read_noise_budget(inner, carrier_hz); });
  if (!model.noise.on) {
    for (const char* key : {"noise_level_db", "noise_budget", "noise_cell_m", "broadside_stripe_db"}) {
      section.warn_if_given(key, "`noise` is false");
    }
  }
  section.number_or_word("output_noise_db", model.noise.output_db, level_db,
                         {{"off", -std::numeric_limits<double>::infinity()}},
                         "noise after the TVG, re full scale");
  section.number("noise_cell_m", model.noise.cell_m, Range::from(0.0, 10.0),
                 "c / 2B of the receiver's band B, within which noise is even. 0: noise has the band of the "
                 "pulse, so the longer a tone is, the lower is the noise");
  section.number("tone_rounding_m", model.pulse.tone_rounding_m, Range::from(0.0, 10.0),
                 "c / 2B of the transducer band; 0: sharp ends");
  section.number("texture_nu", model.speckle.texture_nu, Range::from(0.0, 1000.0),
                 "number of scatterers in a cell at `texture_range_m`, proportional to the range: sand 5 to "
                 "20, gravel and rock 1 to 5, clutter 0.5 to 1; 0: echoes are Rayleigh everywhere");
  section.number("texture_range_m", model.speckle.texture_range_m, Range::above(0.0, 1000.0),
                 "range at which a cell contains `texture_nu` scatterers");
  if (model.speckle.texture_nu == 0.0) {
    section.warn_if_given("texture_range_m", "`texture_nu` is 0");
  }
  section.number_or_word("volume_scattering_db", model.volume_scattering_db, Range::from(-200.0, 0.0),
                         {{"off", -std::numeric_limits<double>::infinity()}},
                         "scattering strength of a cubic metre: -80 clear, -60 turbid");
  section.section("water_clutter", "single objects at fixed places in the water: fish, weed, bubbles",
                  [&](YamlSection& inner) { read_water_clutter(inner, model.water_clutter); });
  section.number("tvg_log_coefficient", model.tvg.log_coefficient, Range::from(0.0, 60.0),
                 "X of the time-varying gain, X log10 r + 2 alpha r");
  section.number("tvg_absorption_db_per_km", model.tvg.absorption_db_per_m, Range::from(0.0, 10'000.0),
                 "alpha of the TVG, one way, as the device assumes", 1000.0);
  section.default_is("tvg_absorption_db_per_km", "absorption of the water");
  section.number("tvg_max_db", model.tvg.max_db, Range::from(0.0, 200.0), "maximum of the time-varying gain");
  section.number("gain_db", model.gain_db, level_db,
                 "output level of unit intensity after TVG, re full scale (80 dB if samples are decibels); "
                 "the client's gain is added");
  section.number("near_field_blank_m", model.near_field_blank_m, Range::from(0.0, 120.0),
                 "range below which the output is 0");
  section.number("broadside_stripe_db", model.noise.broadside_stripe_db, Range::from(0.0, 60.0),
                 "extra noise in the middle of the fan; 0: off");
  section.number("noise_by_bearing_db", model.noise.by_bearing_db, Range::from(0.0, 60.0),
                 "scanning heads: difference of the noise between bearings");
  section.angle("bearing_jitter_deg", model.bearing_jitter_rad, Range::from(0.0, 10.0),
                "scanning heads: standard deviation of the bearing at which a line takes its speckle; "
                "echoes keep their bearing");
  if (!scanning) {
    for (const char* key : {"noise_by_bearing_db", "bearing_jitter_deg"}) {
      section.warn_if_given(key, "this head does not scan");
    }
  }
  section.section("ring_down", "ringing of the transducer after the pulse",
                  [&](YamlSection& inner) { read_ring_down(inner, model.ring_down); });
  section.section("interference", "noise from another sonar or from the vehicle, in some pings",
                  [&](YamlSection& inner) { read_interference(inner, model.noise.interference); });
  section.section("multipath", "ghosts in smooth surfaces, and corner reflectors",
                  [&](YamlSection& inner) { read_multipath(inner, model.multipath); });
  section.boolean(
      "motion_within_ping", model.motion_within_ping,
      "true: receive beams turn with the vehicle while echoes return, which requires a twist in the poses, "
      "or a trajectory; false: the whole ping is received at the pose at which it was sent");
}

void read_paper_model(YamlSection& section, render::PaperModel& model) {
  using Speckle = render::PaperModel::Speckle;
  bool later_release = false;
  section.choice(
      "preset", later_release, {{"paper2017", false}, {"paper2018", true}},
      "start values of the other keys: `paper2017` as in the paper, `paper2018` as in later releases "
      "(attenuation 0.024 per m, folded Gaussian speckle of mean 0.95 and sd 0.30, floor 0.03)");
  if (later_release) {
    model = render::PaperModel::release_2018();
  }
  section.number("sigmoid_slope", model.sigmoid_slope, Range::above(0.0, 1000.0),
                 "beta of the sigmoid S(x) = 1 / (1 + exp(-beta (x - x0)))");
  section.number("sigmoid_centre", model.sigmoid_centre, Range::from(0.0, 1.0), "x0 of the sigmoid");
  section.boolean("two_sided", model.two_sided,
                  "true: surfaces are visible from both sides; false: surfaces are invisible from behind");
  section.boolean("legacy_bin_index", model.legacy_bin_index,
                  "true: ranges are scaled as in the authors' code, so the last bin stays empty");
  section.boolean("legacy_columns", model.legacy_columns,
                  "true: a pixel column belongs to one beam; false: it is cut at beam edges");
  section.boolean("elevation_mask", model.elevation_mask,
                  "false: the whole planar view counts, so edge beams cover less elevation");
  section.boolean("footprint", model.footprint,
                  "false: a sample is a point in range, so the image has holes");
  section.number("attenuation_per_m", model.attenuation_per_m, Range::from(0.0, 10.0),
                 "a of the attenuation exp(-2 a r), applied before the sigmoid");
  section.number("gain", model.gain, Range::from(0.0, 1.0), "gain, applied after speckle; 0.5 is neutral");
  section.choice(
      "speckle", model.speckle,
      {{"gaussian", Speckle::gaussian}, {"folded_gaussian", Speckle::folded_gaussian}, {"off", Speckle::off}},
      "distribution of the multiplicative speckle");
  section.number("speckle_mean", model.speckle_mean, Range::from(0.0, 10.0), "mean of the speckle factor");
  section.number("speckle_sd", model.speckle_sd, Range::from(0.0, 10.0),
                 "standard deviation of the speckle factor");
  section.number("speckle_floor", model.speckle_floor, Range::from(0.0, 1.0),
                 "minimum of the speckle factor");
}

void read_mount(YamlSection& section, HeadConfig& head) {
  read_pose(section, head.T_vehicle_sonar, "origin of the sonar on the vehicle (x forward, y to port, z up)",
            "rotation, as in `poses.initial`; [0, 20, 0] is 20 degrees down");
  section.text("from_world", head.mount_from_world,
               "instead of the other two keys: sonar of the world that gives both "
               "([worlds.md](worlds.md#sonars)). Its name is `bow`, or as much of `rov::sonar_link::bow` as "
               "is unique. It must have the type of this head");
  if (const double arm_m = glm::length(head.T_vehicle_sonar.position_m); arm_m > longest_arm_m) {
    section.warn("position_m", fmt::format("puts the sonar {:.4g} m from the origin of the vehicle (is it in "
                                           "centimetres or millimetres? sonard expects metres)",
                                           arm_m));
  }
  for (const char* key : {"position_m", "rpy_deg"}) {
    if (section.has("from_world") && section.has(key)) {
      section.report(
          key, "cannot be combined with from_world, which gives the whole mount (expected one of them)");
    }
  }
}

/// Reports a model that is given as the type.
void report_model(YamlSection& section, std::span<const HeadType* const> types) {
  for (const HeadType* type : types) {
    for (const std::string_view model : type->models()) {
      if (section.word("type") == model) {
        section.report("type",
                       fmt::format("'{0}' is a model (expected type: {1}, model: {0})", model, type->name()));
      }
    }
  }
}

}  // namespace

HeadConfig read_head(YamlSection& section, const HeadContext& context,
                     std::span<const HeadType* const> types) {
  std::vector<std::pair<std::string_view, const HeadType*>> choices;
  std::vector<std::string_view> names;
  for (const HeadType* type : types) {
    choices.emplace_back(type->name(), type);
    names.push_back(type->name());
  }
  const HeadType* type = types.front();
  report_model(section, types);
  section.require("type", fmt::format("{}", fmt::join(names, " or ")));
  const bool known = section.choice("type", type, choices, "type of device") && section.has("type");
  if (!known && !section.describing()) {
    section.ignore_rest();  // the keys of heads of other types are unknown here
    return {};
  }
  return type->read(section, context);
}

void read_common(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  head.acoustics.sampling = context.sampling;
  head.adaptive_quality = context.adaptive_quality;
  section.require("name", "a name of this head for the log");
  section.text("name", head.name, "unique name; appears in every log line of this head");
  section.section("mount", "pose of the sonar on the vehicle, T_vehicle_sonar",
                  [&](YamlSection& inner) { read_mount(inner, head); });
  section.boolean("hides_vehicle", head.hides_vehicle,
                  "true: the images of this head do not show `world.vehicle_model`");
  section.section("dump", "writes pings to disk as the renderer returned them", [&](YamlSection& inner) {
    inner.require("directory", "a folder to write to");
    inner.path("directory", head.dump_directory.emplace(), context.folder,
               "folder, created if missing; it gets one file per ping");
  });
}

void read_single_beam(YamlSection& section, render::Aperture& aperture) {
  section.angle("beamwidth_deg", aperture.receive_beamwidth_rad, Range::above(0.0, 60.0),
                "width of the beam in azimuth");
  aperture.beam_edges_rad = {aperture.receive_beamwidth_rad / 2, -aperture.receive_beamwidth_rad / 2};
}

void read_receive_array(YamlSection& section, render::Aperture& aperture) {
  section.angle("receive_beamwidth_deg", aperture.receive_beamwidth_rad, Range::from(0.1, 60.0),
                "-3 dB width at broadside, also of speckle and noise");
  using Taper = render::Aperture::Taper;
  using Azimuth = render::Aperture::Azimuth;
  section.choice("azimuth_pattern", aperture.azimuth, {{"array", Azimuth::array}, {"ideal", Azimuth::ideal}},
                 "`array`: overlapping beams with side lobes; `ideal`: sharp beams");
  section.choice("taper", aperture.taper,
                 {{"hamming", Taper::hamming},
                  {"hann", Taper::hann},
                  {"kaiser", Taper::kaiser},
                  {"uniform", Taper::uniform}},
                 "element weights; side lobes of -43, -31, -21, -13 dB");
  section.integer("fine_beams", aperture.fine_beams, 1, 16,
                  "with `array`: number of parts of a beam to which a bearing is resolved");
  using Bearing = render::Aperture::Bearing;
  section.choice("bearing", aperture.bearing, {{"planar", Bearing::planar}, {"conical", Bearing::conical}},
                 "with `array`: a `planar` beam looks at an azimuth; a `conical` beam looks along a cone, as "
                 "in a straight array, so echoes from off the horizontal appear nearer to the axis");
  section.number("element_amplitude_sd", aperture.element_amplitude_sd, Range::from(0.0, 2.0),
                 "with `array`: standard deviation of the elements' amplitudes, as a fraction; errors leak "
                 "strong echoes into all beams");
  section.angle("element_phase_sd_deg", aperture.element_phase_sd_rad, Range::from(0.0, 180.0),
                "with `array`: standard deviation of the elements' phase errors");
  std::uint64_t element_seed = 0;
  section.integer("element_seed", element_seed, 0, max_u64,
                  "seed of the element errors, if they must not follow `seed`");
  section.default_is("element_seed", "`seed`");
  if (section.has("element_seed")) {
    aperture.element_seed = element_seed;
  }
}

void read_acoustics(YamlSection& section, double carrier_hz, HeadConfig& head) {
  render::SonarSettings& settings = head.acoustics;
  section.choice("mode", settings.model,
                 {{"physical", render::Model::physical}, {"paper", render::Model::paper}},
                 "`physical`: sonar equation with noise; `paper`: Cerqueira et al. 2017");
  section.integer("seed", head.seed, 0, max_u64,
                  "seed of all random effects; equal seed, poses and pings give equal bytes");
  section.angle("vertical_beamwidth_deg", settings.aperture.vertical_beamwidth_rad, Range::above(0.0, 170.0),
                "-3 dB full width");
  using Elevation = render::Aperture::Elevation;
  section.choice(
      "elevation_pattern", settings.aperture.elevation,
      {{"top_hat", Elevation::top_hat}, {"sinc", Elevation::sinc}, {"sinc_two_way", Elevation::sinc_two_way}},
      "`top_hat`: sharp vertical edges; `sinc`: pattern of a line array; `sinc_two_way`: its square, for a "
      "head that sends and receives with one array. The last two are rendered to 1.25 beamwidths on either "
      "side");
  const bool scanning = settings.aperture.beam_count() == 1;
  const bool paper = settings.model == render::Model::paper;
  section.warn_if_given(paper ? "physical" : "paper",
                        paper ? "this is mode `paper`" : "this is mode `physical`");
  section.section("physical", "settings of mode `physical`", [&](YamlSection& inner) {
    read_physical_model(inner, carrier_hz, scanning, settings.physical);
  });
  section.section("paper", "settings of mode `paper`",
                  [&](YamlSection& inner) { read_paper_model(inner, settings.paper); });
}

namespace {

/// The violated bounds of the formula (in_absorption_range()), in words; empty if all hold.
std::string outside_of_absorption_range(double carrier_hz, const render::Water& water) {
  std::vector<std::string> outside;
  // Tests each bound alone; the other values are inside the formula's range.
  constexpr double usual_hz = 100'000.0;
  const auto holds = [](double hz, double temperature_c, double salinity_ppt) {
    return render::in_absorption_range(hz, {temperature_c, salinity_ppt, 10.0, 8.0});
  };
  constexpr render::Water usual;
  if (!holds(carrier_hz, usual.temperature_c, usual.salinity_ppt)) {
    outside.push_back(fmt::format("{:.4g} kHz is not within 0.2 to 1000 kHz", 1e-3 * carrier_hz));
  }
  if (!holds(usual_hz, water.temperature_c, usual.salinity_ppt)) {
    outside.push_back(fmt::format("{:.4g} degrees are not within -2 to 30 degrees", water.temperature_c));
  }
  if (!holds(usual_hz, usual.temperature_c, water.salinity_ppt)) {
    outside.push_back(fmt::format("{:.4g} ppt are not within 30 to 35 ppt", water.salinity_ppt));
  }
  return fmt::format("{}", fmt::join(outside, ", "));
}

}  // namespace

void warn_of_absorption(YamlSection& section, const WaterConfig& water, double carrier_hz,
                        std::string_view remedy) {
  const std::string outside = outside_of_absorption_range(
      carrier_hz, {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph});
  if (!outside.empty()) {
    section.warn_of("water",
                    fmt::format("the formula of the absorption is not valid here: {}. Its error may exceed "
                                "10 % (to set the absorption, use {})",
                                outside, remedy));
  }
}

void apply_water(YamlSection& section, const HeadContext& context, double carrier_hz, HeadConfig& head) {
  const WaterConfig& w = context.water;
  const render::Water water{w.temperature_c, w.salinity_ppt, w.depth_m, w.ph};
  double absorption = context.absorption_db_per_m;
  if (absorption < 0.0) {
    absorption = render::francois_garrison_absorption_db_per_m(carrier_hz, water);
    warn_of_absorption(section, w, carrier_hz, "water.absorption_db_per_km");
  }
  head.acoustics.physical.absorption_db_per_m = absorption;
  head.acoustics.physical.multipath.wavelength_m = render::sound_speed_mps(water) / carrier_hz;
  // By default, the device's own absorption setting matches the water.
  head.acoustics.physical.tvg.absorption_db_per_m = absorption;
}

}  // namespace sonard::server
