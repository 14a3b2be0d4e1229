// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/sonar3d15/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "clients/sonarview/common/link_arguments.hpp"

namespace sonard::client {

Sonar3d15Arguments::Sonar3d15Arguments(CLI::App& app) {
  const auto add = [&](const char* group, const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->capture_default_str()->group(group);
  };
  add("Link", "--head", options_.head, "Address of the head")->required();
  add("Link", "--port", options_.port, "Port of its HTTP interface")->check(CLI::Range(1, 65535));
  add("Link", "--interface", interface_, "Own address on the head's network, to join the multicast group");
  add("Sonar", "--frequency", frequency_, "low: 90 x 40 degrees, 5 per second; high: 40 x 40, 20 per second")
      ->check(CLI::IsMember({"low", "high"}));
  add("Sonar", "--range", range_m_, "Range in metres")->check(CLI::Range(0.5, 16.0));
  add("Sonar", "--least-range", least_range_m_, "Nearer echoes are left out")->check(CLI::Range(0.0, 15.0));
  add("Sonar", "--sound-speed", sound_speed_mps_, "Sound speed in metres per second; 0: the head chooses")
      ->check(CLI::Range(1000.0, 2000.0) | CLI::IsMember({0}));
  run_.declare(app, {});
}

Sonar3d15Options Sonar3d15Arguments::options() const {
  if (least_range_m_ >= range_m_) {
    throw CLI::ValidationError("--least-range", "is not less than --range");
  }
  Sonar3d15Options options = options_;
  options.interface = ipv4_argument("--interface", interface_);
  options.settings = {
      set("acoustics/mode", fmt::format(R"("{}-frequency")", frequency_)),
      set("acoustics/range", fmt::format(R"({{"min": {}, "max": {}}})", least_range_m_, range_m_)),
      set("acoustics/speed_of_sound", fmt::format("{}", sound_speed_mps_)),
      set("udp", R"({"mode": "multicast", "unicast_destination_ip": "", "unicast_destination_port": 0})"),
      set("acoustics/enabled", "true")};
  options.run = run_.options();
  return options;
}

sonar3d15::Request set(const std::string& path, std::string body) {
  return {.method = "POST", .path = "/api/v1/integration/" + path, .body = std::move(body), .stays = true};
}

}  // namespace sonard::client
