// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/oculus/options.hpp"

#include <CLI/CLI.hpp>
#include <map>

#include "clients/sonarview/common/link_arguments.hpp"

namespace sonard::client {
namespace {

/// Ping rates in hertz, and their codes in a fire message.
const std::map<int, std::uint8_t>& rate_codes() {
  static const std::map<int, std::uint8_t> codes{{10, 0}, {15, 1}, {40, 2}, {5, 3}, {2, 4}};
  return codes;
}

}  // namespace

OculusArguments::OculusArguments(CLI::App& app) {
  options_.fire.version = 2;
  options_.fire.extension.emplace();
  options_.fire.fire.sound_speed_mps = 1500.0;
  declare_link(app);
  declare_sonar(app);
  run_.declare(app, {});
}

void OculusArguments::declare_link(CLI::App& app) {
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Link");
  };
  add("--head", options_.head, "Address of the head; default: the address in the first status packet");
  add("--port", options_.port, "TCP port of the head")->check(CLI::Range(1, 65535));
  add("--bind", bind_address_, "Local address that receives status packets");
  add("--status-port", options_.status_port, "Local port that receives status packets")
      ->check(CLI::Range(1, 65535));
}

void OculusArguments::declare_sonar(CLI::App& app) {
  oculus::Fire& fire = options_.fire.fire;
  const auto add = [&](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group("Sonar");
  };
  add("--frequency", frequency_, "low: the wide fan; high: the narrow one")
      ->check(CLI::IsMember({"low", "high"}));
  add("--range", range_m_, "Range in metres; the head images as much of it as it can")
      ->check(CLI::Range(0.1, 200.0));
  add("--beams", beams_, "Beams in the fan")->check(CLI::IsMember({256, 512}));
  add("--bits", bits_, "Bits per sample")->check(CLI::IsMember({8, 16, 32}));
  add("--gain", fire.gain_percent, "Gain in percent")->check(CLI::Range(0.0, 100.0));
  add("--gamma", fire.gamma, "Samples are the amplitude to the power of this / 255")
      ->check(CLI::Range(1, 255));
  add("--rate", rate_hz_, "Maximum pings per second")->check(CLI::IsMember({2, 5, 10, 15, 40}));
  add("--sound-speed", fire.sound_speed_mps,
      "Sound speed in metres per second; 0: computed from the salinity and the measurements of the head")
      ->check(CLI::Range(0.0, 1600.0));
  add("--salinity", fire.salinity_ppt, "Salinity in parts per thousand; 0: fresh water")
      ->check(CLI::Range(0.0, 50.0));
  app.add_flag("--row-gains", row_gains_, "Request four bytes of gain before each row of the image")
      ->group("Sonar");
}

OculusOptions OculusArguments::options() const {
  namespace flags = oculus::fire_flags;
  OculusOptions options = options_;
  options.bind_address = ipv4_argument("--bind", bind_address_);
  oculus::Fire& fire = options.fire.fire;
  fire.master_mode = frequency_ == "low" ? 1 : 2;
  fire.ping_rate = rate_codes().at(rate_hz_);
  fire.range = range_m_;
  const int asked = flags::range_in_metres | flags::simple_result | (beams_ == 512 ? flags::beams_512 : 0) |
                    (bits_ > 8 ? flags::sixteen_bit : 0) | (row_gains_ ? flags::row_gains : 0);
  fire.flags = static_cast<std::uint8_t>(asked);
  options.fire.extension->flags = bits_ == 32 ? oculus::extension_flags::thirty_two_bit : 0;
  options.run = run_.options();
  return options;
}

}  // namespace sonard::client
