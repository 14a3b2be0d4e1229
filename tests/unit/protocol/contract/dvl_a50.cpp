// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <string_view>

#include "protocol/dvl_a50/client.hpp"
#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace dvl_a50;

constexpr int serial_channel = 1, http_channel = 2;

std::vector<std::uint8_t> bytes(std::string_view text) {
  return {text.begin(), text.end()};
}
std::vector<std::uint8_t> acoustics(bool on) {
  return bytes(
      command_text("set_config", on ? R"({"acoustic_enabled":true})" : R"({"acoustic_enabled":false})"));
}

class DvlHead final : public Head {
 public:
  explicit DvlHead(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  void connect(DeviceBench& bench) const override {
    bench.step(ClientCame{client()});
    bench.receive(client(), acoustics(false));
  }
  void request(DeviceBench& bench) const override { bench.receive(client(), acoustics(true)); }
  void cancel(DeviceBench& bench) const override { bench.receive(client(), acoustics(false)); }
  void leave(DeviceBench& bench) const override {
    cancel(bench);
    bench.step(ClientGone{client()});
  }

  ReplayedPing recorded() const override {
    ReplayedPing ping;
    ping.settings = {.bins = 50, .beams = 1, .bin_m = 0.04, .sound_speed_mps = 1475.0};
    ping.wire = record_of({.altitude_m = 1.5, .valid = true}, 2.0, 1475.0).wire;
    return ping;
  }

  Peer client() const override { return {json_channel, {0x7F000001, 4000}, 0}; }
  std::vector<Peer> clients() const override {
    return {client(), {json_channel, {0x7F000001, 4001}, 0}, {serial_channel, {}, 0}};
  }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    return {acoustics(true),
            bytes(command_text("get_config")),
            acoustics(true),
            bytes("wcs,,,y,,,\r\n"),
            acoustics(true),
            bytes(command_text("trigger_ping")),
            acoustics(true),
            bytes("wcp,3\n"),
            bytes("wcx*00\n"),
            acoustics(true),
            bytes(command_text("set_config", R"({"range_mode":"=1"})")),
            bytes(command_text("calibrate_gyro"))};
  }
  bool can_read(std::span<const std::uint8_t> message) const override {
    const std::string text(message.begin(), message.end());
    if (!text.starts_with('{')) {
      return text.ends_with("\r\n");  // of the serial line
    }
    dvl_a50::Client reader;
    reader.on_bytes(message);
    return reader.take().size() == 1;
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    config.settings.acoustic_enabled = false;
    config.search_interval = std::chrono::milliseconds(100);  // the images show no bottom
    if (mode.options != 0) {
      config.serial_channel = serial_channel;
      config.http_channel = http_channel;
      config.time_scale = (mode.options & 1) != 0 ? 0.0 : 1.0;
      config.release = (mode.options & 2) != 0 ? Release::v2_4_0 : Release::v2_7_2;
      config.processing_delay = std::chrono::milliseconds(mode.options % 300);
    }
    return config;
  }

  dvl_a50::Device device_;
};

}  // namespace

std::unique_ptr<Head> dvl_a50_head(const Mode& mode) {
  return std::make_unique<DvlHead>(mode);
}

}  // namespace sonard::contract
