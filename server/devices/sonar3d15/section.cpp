// SPDX-License-Identifier: Apache-2.0
#include "server/devices/sonar3d15/section.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "renderer/acoustics/water.hpp"
#include "server/net/interfaces.hpp"
#include "server/yaml/status_section.hpp"

namespace sonard::server {
namespace {

using sonar3d15::ModeConfig;
using sonar3d15::PacketId;
using sonar3d15::Release;
using sonar3d15::UdpMode;

constexpr double absorption_of_water = -1.0;
constexpr double most_fov_deg = 150.0;  // and the beams must stay within 80 degrees of the axis
constexpr TextForm release_form{"a release such as 1.8.0", "release",
                                R"("type": "string", "pattern": "^[0-9]+[.][0-9]+[.][0-9]+$")"};

std::optional<Release> parse_release(std::string_view text) {
  Release release;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (int* part : {&release.major, &release.minor, &release.patch}) {
    const auto [rest, error] = std::from_chars(at, end, *part);
    const bool last = part == &release.patch;
    if (error != std::errc{} || *part < 0 || (last ? rest != end : rest == end || *rest != '.')) {
      return std::nullopt;
    }
    at = rest + 1;
  }
  return release;
}

void read_network(YamlSection& section, Sonar3d15Config& config) {
  section.require("address", "the address that clients connect to");
  config.interface = read_own_address(
      section, "address", config.address,
      "address of the HTTP interface, and source of all images, or the interface with this address. If the "
      "address of the interface changes, the head follows it");
  if (section.has("address")) {
    check_host_address(section, "address", config.address);
  }
  section.integer("http_port", config.http_port, 1, 65535,
                  "TCP port of the HTTP interface; clients of the real head use 80");
  section.choice(
      "udp_mode", config.device.udp_mode,
      {{"multicast", UdpMode::multicast}, {"unicast", UdpMode::unicast}, {"disabled", UdpMode::disabled}},
      "destination of the images at start: 224.0.0.96 port 4747, `unicast`, or none");
  section.parsed("unicast", config.device.unicast, &parse_endpoint, endpoint_form,
                 "destination at start with `udp_mode: unicast`");
  if (config.device.udp_mode == UdpMode::unicast) {
    section.require("unicast", "the address and port of the client");
  }
  section.integer("multicast_ttl", config.multicast_ttl, 1, 255, "routers that multicast may pass, plus 1");
  read_allow_list(section, config.address, config.allow,
                  "address blocks of clients that the HTTP interface serves; any host may receive images");
}

void read_start(YamlSection& section, sonar3d15::DeviceConfig& device) {
  section.boolean("acoustics", device.acoustics, "true: the head sends images before a client asks");
  section.number("least_range_m", device.least_range_m, Range::from(0.0, 50.0), "minimum range");
  section.number("range_m", device.range_m, Range::above(0.0, 50.0), "maximum range");
  section.integer("first_sequence", device.first_sequence, 0, std::numeric_limits<std::uint32_t>::max(),
                  "number of the first shot");
  if (device.range_m <= device.least_range_m) {
    section.report("range_m", "is not beyond least_range_m (expected a larger range)");
  }
}

void read_imu(YamlSection& section, sonar3d15::DeviceConfig& device) {
  section.number("force_noise_mps2", device.imu_force_noise_mps2, Range::from(0.0, 100.0),
                 "standard deviation of each specific force");
  section.number("rate_noise_dps", device.imu_rate_noise_radps, Range::from(0.0, 100.0),
                 "standard deviation of each rate of turn", 180.0 / std::numbers::pi);
  section.integer("batch_samples", device.imu_batch_samples, 0, 1000,
                  "samples of a batch, 100 a second; 0: those of one shot");
}

void read_device(YamlSection& section, sonar3d15::DeviceConfig& device) {
  section.parsed("release", device.release, &parse_release, release_form,
                 "version of the software: selects paths, packets and status");
  section.default_is("release", "1.8.0", R"("1.8.0")");
  section.choice("packets", device.packets,
                 {{"by_release", std::nullopt}, {"rip1", PacketId::rip1}, {"rip2", PacketId::rip2}},
                 "framing of the images: RIP2 is compressed, from release 1.6.0 on");
  section.number("most_range_m", device.most_range_m, Range::above(0.0, 50.0),
                 "longest range that a client may set");
  section.integer("width", device.columns, 2, 1024, "number of columns of an image");
  section.integer("height", device.rows, 2, 1024, "number of rows of an image");
  section.number("pixel_scale_m", device.pixel_scale_m, Range::above(0.0, 1.0),
                 "range of one unit in the range image");
  section.default_is("pixel_scale_m", "50/65536");
  section.number("range_step_us", device.range_step_s, Range::above(0.0, 1000.0),
                 "ranges are whole numbers of steps: one-way time of a step", 1e6);
  section.number("automatic_sound_speed_mps", device.automatic_sound_speed_mps, Range::from(1000.0, 2000.0),
                 "speed that the head assumes if a client sets 0");
  section.number("inside_temperature_c", device.temperature_c, Range::from(-20.0, 100.0),
                 "temperature inside; from 60 on, acoustics stay off");
  section.boolean("ntp_synced", device.ntp_synced,
                  "false: no time server answers, and a client may set the time");
  section.duration("clock_offset_s", device.clock_offset, Range::from(-1e9, 1e9),
                   "with `ntp_synced: false`: how much the head's clock is ahead until a client sets it");
  section.duration(
      "speed_change_s", device.speed_change_time, Range::from(0.0, 3600.0),
      "time until shots have a speed of sound that a client has set; a real head takes about 20 s");
  section.boolean("sends_shaded", device.sends_shaded,
                  "sends a third image of each shot, type 1: how directly each surface faces the head");
  section.section("imu", "motion sensor", [&](YamlSection& inner) { read_imu(inner, device); });
  section.section("start", "settings until a client changes them",
                  [&](YamlSection& inner) { read_start(inner, device); });
  if (device.range_m > device.most_range_m) {
    section.report("most_range_m", "is less than start.range_m (expected at least as much)");
  }
  if (device.columns > 20'000 / device.rows) {
    section.report("height", "makes images of more than 20000 pixels (expected fewer rows or columns)");
  }
}

/// @param absorption_db_per_km may be absorption_of_water
void read_mode(YamlSection& section, ModeConfig& mode, Sonar3d15ModeAcoustics& acoustics,
               double& absorption_db_per_km) {
  section.number("rate_hz", mode.rate_hz, Range::from(0.001, 1000.0), "shots per second");
  section.duration("latency_ms", mode.latency, Range::from(0.0, 10'000.0), "from the pulse to the images");
  section.number("horizontal_fov_deg", mode.horizontal_fov_deg, Range::above(0.0, most_fov_deg),
                 "angle from the first column to the last");
  section.number("vertical_fov_deg", mode.vertical_fov_deg, Range::above(0.0, most_fov_deg),
                 "angle from the lowest row to the highest");
  section.angle("horizontal_beamwidth_deg", acoustics.horizontal_beamwidth_rad, Range::above(0.0, 20.0),
                "-3 dB width of one beam");
  section.angle("vertical_beamwidth_deg", acoustics.vertical_beamwidth_rad, Range::above(0.0, 20.0),
                "-3 dB height of one beam");
  section.integer("frequency_field", mode.frequency_field, 0, std::numeric_limits<std::uint32_t>::max(),
                  "field `frequency` of the images");
  section.number_or_word("absorption_db_per_km", absorption_db_per_km, Range::from(0.0, 100'000.0),
                         {{"of_water", absorption_of_water}}, "one-way absorption at this frequency");
}

void read_modes(YamlSection& section, const WaterConfig& water, Sonar3d15Config& config) {
  const auto read = [&](const char* key, const char* meaning, ModeConfig& mode,
                        Sonar3d15ModeAcoustics& acoustics) {
    double absorption_db_per_km = absorption_of_water;
    section.section(key, meaning,
                    [&](YamlSection& inner) { read_mode(inner, mode, acoustics, absorption_db_per_km); });
    acoustics.absorption_db_per_m =
        absorption_db_per_km >= 0.0
            ? absorption_db_per_km / 1000.0
            : render::francois_garrison_absorption_db_per_m(
                  mode.carrier_hz, {water.temperature_c, water.salinity_ppt, water.depth_m, water.ph});
  };
  read("low_frequency", "mode `low-frequency`, 1.2 MHz", config.device.low, config.modes[0]);
  read("high_frequency", "mode `high-frequency`, 2.4 MHz", config.device.high, config.modes[1]);
}

void read_sonar3d15_acoustics(YamlSection& section, HeadConfig& head, sonar3d15::DeviceConfig& device) {
  section.introduce(
      "Directions have neither noise nor speckle, and no echoes of the water or by mirrors: the head sends "
      "the strongest echo of each direction, if it exceeds the threshold.");
  double gain_db = std::round(2000.0 * std::log10(device.gain)) / 100.0;
  section.number("gain_db", gain_db, Range::from(0.0, 300.0),
                 "20 log10 of the linear strength of an echo as strong as the source at 1 m");
  device.gain = std::pow(10.0, gain_db / 20.0);
  section.number("threshold", device.threshold, Range::from(30.0, 32'767.0),
                 "linear strength that an echo must exceed; a signal of 1 is 30");
  section.number("range_resolution_mm", device.range_bin_m, Range::from(2.0, 1000.0), "c / 2B of the pulse",
                 2000.0);
  using Backscatter = render::PhysicalModel::Backscatter;
  section.choice(
      "backscatter", head.acoustics.physical.backscatter,
      {{"lambert_facet", Backscatter::lambert_facet}, {"lambert", Backscatter::lambert}},
      "`lambert_facet`: materials show facets near normal incidence; `lambert`: they only scatter diffusely");
}

}  // namespace

Sonar3d15Config read_sonar3d15_head(YamlSection& section, const HeadContext& context, HeadConfig& head) {
  section.introduce(
      "A Water Linked Sonar 3D-15 ([messages](../protocol/sonar3d15/README.md)): a range image and a "
      "signal image of 256 by 64 directions. The x axis of its mount is the middle of the field of view.");
  Sonar3d15Config config = sonar3d15_defaults();
  sonar3d15::DeviceConfig& device = config.device;
  if (context.water_sound_speed_mps > 0.0) {
    device.water_sound_speed_mps = context.water_sound_speed_mps;
  }
  device.simulated_time = context.simulated_time;
  read_common(section, context, head);
  section.require("network", "a mapping with an address");
  section.section("network", "addresses and ports", [&](YamlSection& inner) { read_network(inner, config); });
  section.section("device", "what the head reports, and its settings at start",
                  [&](YamlSection& inner) { read_device(inner, device); });
  section.number("time_scale", device.time_scale, Range::from(0.0, 1000.0),
                 "factor on the time from shot to shot; 0: as fast as shots are rendered");
  read_modes(section, context.water, config);
  section.section("acoustics", "formation of the images",
                  [&](YamlSection& inner) { read_sonar3d15_acoustics(inner, head, device); });
  return config;
}

}  // namespace sonard::server
