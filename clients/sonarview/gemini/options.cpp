// SPDX-License-Identifier: Apache-2.0
#include "clients/sonarview/gemini/options.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <set>

#include "clients/sonarview/common/link_arguments.hpp"

namespace sonard::client {

GeminiArguments::GeminiArguments(CLI::App& app) {
  const auto add = [&app](const char* group, const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->group(group);
  };
  add("Link", "--client-address", client_address_,
      "Local address that sends commands, port 52901; default: the address that routes to the head");
  add("Link", "--bind", bind_address_, "Local address that receives replies and status packets, port 52900")
      ->capture_default_str();
  add("Link", "--head", head_address_,
      "Address of the head, port 52901; default: the alternate address in its status packet");
  add("Link", "--sonar-id", options_.sonar_ids,
      "Sonar ID of the head, or several (513,514), each with its own folder in --out; 0: the first head that "
      "sends a status packet")
      ->delimiter(',')
      ->capture_default_str();

  auto& settings = options_.settings;
  add("Sonar", "--range", settings.range_m, "Range in metres")
      ->check(CLI::Range(0.3, 150.0))
      ->capture_default_str();
  add("Sonar", "--gain", settings.gain_percent, "Gain in percent")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str();
  add("Sonar", "--sound-speed", settings.sound_speed_mps,
      "Sound speed in metres per second, to convert times to ranges")
      ->check(CLI::Range(1400.0, 1588.0))
      ->capture_default_str();
  add("Sonar", "--compression", settings.compression_log2,
      "0..4: average 1, 2, 4, 8 or 16 range lines into one")
      ->check(CLI::Range(0, 4))
      ->capture_default_str();
  add("Sonar", "--rle", settings.rle_threshold,
      "Samples below this become zero and are run-length coded; 0: off")
      ->check(CLI::Range(0, 255))
      ->capture_default_str();
  add("Sonar", "--bits", bits_, "Bits per sample")->check(CLI::IsMember({8, 16}))->capture_default_str();
  add("Sonar", "--continuous", interval_ms_,
      "Let the head ping by itself at this interval, in milliseconds; default: request each ping")
      ->check(CLI::Range(1.0, 1e6));

  run_.declare(app, {.wait = "Seconds to wait for the first status packet"});

  add("Test of the link", "--drop-rx", options_.drop_rx, "Fraction of arriving datagrams to drop on purpose")
      ->check(CLI::Range(0.0, 1.0));
  add("Test of the link", "--drop-tx", options_.drop_tx, "Fraction of sent datagrams to drop on purpose")
      ->check(CLI::Range(0.0, 1.0));
  add("Test of the link", "--seed", options_.seed, "Seed that selects the dropped datagrams")
      ->capture_default_str();
}

GeminiOptions GeminiArguments::options() const {
  GeminiOptions options = options_;
  options.bind_address = ipv4_argument("--bind", bind_address_);
  if (!client_address_.empty()) {
    options.client_address = ipv4_argument("--client-address", client_address_);
    if (options.client_address == 0) {
      throw CLI::ValidationError("--client-address", "must name one address of this machine");
    }
  }
  if (!head_address_.empty()) {
    options.head_address = ipv4_argument("--head", head_address_);
  }
  std::set<std::uint16_t> ids;
  for (const std::uint16_t id : options.sonar_ids) {
    if (id == 1) {
      throw CLI::ValidationError("--sonar-id", "1 is reserved for production");
    }
    if (!ids.insert(id).second || (id == 0 && options.sonar_ids.size() > 1)) {
      throw CLI::ValidationError("--sonar-id", "each of several heads needs an ID other than 0");
    }
  }
  options.settings.sixteen_bit = bits_ == 16;
  if (interval_ms_ > 0.0) {
    options.settings.interval = std::chrono::microseconds{std::llround(interval_ms_ * 1e3)};
  }
  options.run = run_.options();
  return options;
}

}  // namespace sonard::client
