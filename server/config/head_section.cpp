#include "server/config/head_section.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "renderer/acoustics/water.hpp"
#include "server/config/addresses.hpp"

namespace sonard::server {
namespace {

constexpr double carrier_hz = 723'380.0;  // docs/protocols/gemini.md 9
constexpr std::uint64_t max_u64 = std::numeric_limits<std::uint64_t>::max();
constexpr double minute_ms = 60'000.0;
constexpr Range probability = Range::from(0.0, 1.0);
constexpr Range level_db = Range::from(-300.0, 300.0);
constexpr std::string_view expected_address = "an IPv4 address such as 127.0.0.2";

void read_identity(YamlSection& section, GeminiHeadConfig& head) {
  section.require("name", "a name of this head for the log");
  section.text("name", head.name);

  enum class Type { gemini_720i } type{};
  section.require("type", "gemini_720i");
  section.choice("type", type, {{"gemini_720i", Type::gemini_720i}});

  // 0 means "not set" and 1 is reserved for production: clients send nothing to either
  // (docs/protocols/gemini.md 1.4).
  section.require("sonar_id", "a whole number from 2 to 65535");
  section.integer("sonar_id", head.device.sonar_id, 2, 65535);
}

/// An address that a head can own or talk to.
void check_host_address(YamlSection& section, std::string_view key, Ipv4 address) {
  if (address == 0 || is_multicast(address) || address == 0xFFFFFFFF) {
    section.report(key, fmt::format("{} is not the address of one host (expected {})", address_text(address),
                                    expected_address));
  }
}

void check_inside_network(YamlSection& section, const gemini::DeviceConfig& device) {
  const std::optional<int> prefix = prefix_length_of(device.netmask);
  if (!prefix || *prefix == 0) {
    section.report("netmask",
                   fmt::format("{} is not a netmask (expected leading ones only, such as 255.255.255.0)",
                               address_text(device.netmask)));
    return;
  }
  const Ipv4 host = device.alternate_address & ~device.netmask;
  if (*prefix <= 30 && (host == 0 || host == ~device.netmask)) {
    section.report(
        "alternate_address",
        fmt::format("{} is the {} address of its network (expected the address of one host under mask {})",
                    address_text(device.alternate_address), host == 0 ? "first" : "broadcast",
                    address_text(device.netmask)));
  }
}

void read_status_destination(YamlSection& section, const gemini::DeviceConfig& device,
                             StatusDestination& status) {
  using Mode = StatusDestination::Mode;
  if (section.is_list("status")) {
    status.mode = Mode::unicast;
    section.parsed_list("status", status.hosts, &parse_ipv4, expected_address);
    if (status.hosts.empty()) {
      section.report("status", "no host is listed (expected at least one address)");
    }
    for (const Ipv4 host : status.hosts) {
      check_host_address(section, "status", host);
    }
    return;
  }
  section.choice(
      "status", status.mode,
      {{"limited_broadcast", Mode::limited_broadcast}, {"directed_broadcast", Mode::directed_broadcast}});
  const std::optional<int> prefix = prefix_length_of(device.netmask);
  if (status.mode == Mode::directed_broadcast && prefix && *prefix > 30) {
    section.report("status",
                   fmt::format("mask {} leaves no broadcast address (expected limited_broadcast or a list)",
                               address_text(device.netmask)));
  }
}

void read_network(YamlSection& section, GeminiHeadConfig& head, std::vector<ConfigWarning>& warnings) {
  gemini::DeviceConfig& device = head.device;
  section.require("alternate_address", "the address that clients find in the status packets");
  section.parsed("alternate_address", device.alternate_address, &parse_ipv4, expected_address);
  if (section.has("alternate_address")) {
    check_host_address(section, "alternate_address", device.alternate_address);
  }
  section.require("netmask", "the mask of the interface that is served, such as 255.255.255.0");
  section.parsed("netmask", device.netmask, &parse_ipv4, "a netmask such as 255.255.255.0");
  check_inside_network(section, device);
  section.parsed("fixed_address", device.fixed_address, &parse_ipv4, expected_address);
  check_host_address(section, "fixed_address", device.fixed_address);

  head.bind_address = device.alternate_address;
  section.place_default("bind", "alternate_address");
  section.parsed("bind", head.bind_address, &parse_ipv4,
                 "an address of this machine, or 0.0.0.0 for all of them");
  if (head.bind_address != 0 && head.bind_address != device.alternate_address) {
    warnings.push_back(
        {section.path_of("bind"),
         fmt::format("clients send to the alternate address {}, but only {} is listened on",
                     address_text(device.alternate_address), address_text(head.bind_address))});
  }
  section.integer("command_port", head.command_port, 1, 65535);
  section.integer("surface_port", head.surface_port, 1, 65535);

  const std::uint16_t id = device.sonar_id;
  device.mac = {
      0x00, 0x12, 0x34, 0x00, static_cast<std::uint8_t>(id >> 8), static_cast<std::uint8_t>(id & 255U)};
  section.parsed("mac", device.mac, &parse_mac, "six hexadecimal octets such as 00:12:34:00:02:01");
  section.boolean("accept_id_zero", device.accept_id_zero);

  read_status_destination(section, device, head.status);
  read_allow_list(section, head.bind_address, head.allow);
  for (const Ipv4 host : head.status.hosts) {
    if (!head.allow.empty() && !allows(head.allow, host)) {
      warnings.push_back(
          {section.path_of("status"),
           fmt::format("{} gets status packets but is not in `allow`: its commands are dropped",
                       address_text(host))});
    }
  }
}

void read_timing(YamlSection& section, gemini::DeviceConfig& device) {
  section.duration("status_period_ms", device.status_period, Range::from(10.0, minute_ms));
  section.duration("min_ping_period_ms", device.min_ping_period, Range::from(1.0, minute_ms));
  section.duration("surface_timeout_ms", device.surface_timeout, Range::from(10.0, 3600.0 * 1000.0));
  section.duration("reboot_time_ms", device.reboot_time, Range::from(0.0, minute_ms));
  section.duration("line_period_us", device.line_period, Range::from(1.0, 10'000.0));
  section.integer("burst_lines", device.burst_lines, 1, 1024);
  section.duration("retry_hold_ms", device.retry_hold, Range::from(0.0, 10'000.0));
  section.duration("retry_hold_max_ms", device.retry_hold_max, Range::from(0.0, 10'000.0));
  if (device.retry_hold_max < device.retry_hold) {
    section.report("retry_hold_max_ms", "is shorter than retry_hold_ms (expected at least as long)");
  }
  section.duration("render_lead_ms", device.render_lead, Range::from(0.0, 1000.0));
}

void read_gain_law(YamlSection& section, gemini::GainLaw& law) {
  section.number("reference_spreading", law.reference_spreading, Range::above(0.0, 1023.0));
  section.number("db_per_percent", law.db_per_percent, Range::from(0.0, 10.0));
  section.number("nominal_main_gain_db", law.nominal_main_gain_db, Range::from(0.0, 100.0));
}

void read_physical_model(YamlSection& section, render::PhysicalModel& model) {
  using Speckle = render::PhysicalModel::Speckle;
  section.choice("speckle", model.speckle,
                 {{"ou", Speckle::ou},
                  {"frozen", Speckle::frozen},
                  {"per_ping", Speckle::per_ping},
                  {"off", Speckle::off}});
  section.number("aperture_m", model.aperture_m, Range::above(0.0, 10.0));
  section.boolean("noise", model.noise);
  section.number("noise_level_db", model.noise_level_db, level_db);
  section.number("tvg_log_coefficient", model.tvg_log_coefficient, Range::from(0.0, 60.0));
  double tvg_absorption_db_per_km = model.tvg_absorption_db_per_m * 1000.0;
  section.number("tvg_absorption_db_per_km", tvg_absorption_db_per_km, Range::from(0.0, 10'000.0));
  model.tvg_absorption_db_per_m = tvg_absorption_db_per_km / 1000.0;
  section.number("tvg_max_db", model.tvg_max_db, Range::from(0.0, 200.0));
  section.number("gain_db", model.gain_db, level_db);
  section.number("near_field_blank_m", model.near_field_blank_m, Range::from(0.0, 120.0));
  section.number("broadside_stripe_db", model.broadside_stripe_db, Range::from(0.0, 60.0));
  section.number("side_lobe_floor_db", model.side_lobe_floor_db, Range::from(-200.0, 0.0));
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

void read_acoustics(YamlSection& section, GeminiHeadConfig& head) {
  render::SonarSettings& settings = head.acoustics;
  section.choice("mode", settings.model,
                 {{"physical", render::Model::physical}, {"paper", render::Model::paper}});
  section.integer("seed", head.seed, 0, max_u64);
  section.angle("vertical_beamwidth_deg", settings.aperture.vertical_beamwidth_rad, Range::above(0.0, 170.0));
  section.angle("receive_beamwidth_deg", settings.aperture.receive_beamwidth_rad, Range::above(0.0, 60.0));
  using Elevation = render::Aperture::Elevation;
  section.choice("elevation_pattern", settings.aperture.elevation,
                 {{"top_hat", Elevation::top_hat}, {"sinc", Elevation::sinc}});
  section.boolean("snap_sound_speed", head.device.snap_sound_speed);
  section.section("gain_law", [&](YamlSection& inner) { read_gain_law(inner, head.device.gain); });
  section.section("physical", [&](YamlSection& inner) { read_physical_model(inner, settings.physical); });
  section.section("paper", [&](YamlSection& inner) { read_paper_model(inner, settings.paper); });
}

void read_faults(YamlSection& section, LinkFaults& faults) {
  section.number("loss", faults.loss, probability);
  section.number("duplicate", faults.duplicate, probability);
  section.number("reorder", faults.reorder, probability);
  section.duration("delay_ms", faults.delay, Range::from(0.0, minute_ms));
  section.duration("jitter_ms", faults.jitter, Range::from(0.0, minute_ms));
}

void read_link(YamlSection& section, LinkConfig& link) {
  section.integer("seed", link.seed, 0, max_u64);
  section.section("to_surface", [&](YamlSection& inner) { read_faults(inner, link.to_surface); });
  section.section("from_surface", [&](YamlSection& inner) { read_faults(inner, link.from_surface); });
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

void apply_water(const HeadContext& context, GeminiHeadConfig& head, std::vector<ConfigWarning>& warnings) {
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
  // The device's own absorption setting matches the water unless the user says otherwise.
  head.acoustics.physical.tvg_absorption_db_per_m = absorption;
  head.device.water_sound_speed_mps = context.water_sound_speed_mps;
}

}  // namespace

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

void read_allow_list(YamlSection& section, Ipv4 bind_address, AllowList& allow) {
  constexpr std::string_view expected = "an address block such as 10.61.19.0/24";
  if (is_loopback(bind_address)) {
    allow = {{0x7F000000, 8}};
  } else if (bind_address != 0 || section.has("bind")) {  // otherwise the address itself was refused
    section.require("allow", "the address blocks to serve, as the socket is not bound to loopback");
  }
  section.parsed_list("allow", allow, &parse_cidr, expected);
  if (section.is_list("allow") && allow.empty()) {
    section.report("allow", "nobody is listed (expected at least one address block)");
  }
}

GeminiHeadConfig read_gemini_head(YamlSection& section, const HeadContext& context,
                                  std::vector<ConfigWarning>& warnings) {
  GeminiHeadConfig head;
  head.acoustics.sampling = context.sampling;
  apply_water(context, head, warnings);
  read_identity(section, head);
  section.require("network", "a mapping with alternate_address and netmask");
  section.section("network", [&](YamlSection& inner) { read_network(inner, head, warnings); });
  section.section("timing", [&](YamlSection& inner) { read_timing(inner, head.device); });
  section.section("mount", [&](YamlSection& inner) { read_pose(inner, head.T_vehicle_sonar); });
  section.section("acoustics", [&](YamlSection& inner) { read_acoustics(inner, head); });
  section.section("link", [&](YamlSection& inner) { read_link(inner, head.link); });
  section.section("trigger", [&](YamlSection& inner) {
    Endpoint bind;
    inner.require("bind", "an address and port such as 127.0.0.1:14700");
    inner.parsed("bind", bind, &parse_endpoint, "an address and port such as 127.0.0.1:14700");
    head.trigger = bind;
  });
  section.section("dump", [&](YamlSection& inner) {
    std::string directory;
    inner.require("directory", "a folder to write to");
    inner.text("directory", directory);
    head.dump_directory = context.folder / directory;
  });
  return head;
}

}  // namespace sonard::server
