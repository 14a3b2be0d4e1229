// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/device.hpp"
#include "protocol/sonar3d15/http.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace sonar3d15;

std::vector<std::uint8_t> acoustics(const char* body) {
  return sonar3d15::encode(Request{"POST", "/api/v1/integration/acoustics/enabled", body});
}

class Sonar3d15Head final : public Head {
 public:
  explicit Sonar3d15Head(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  void connect(DeviceBench& bench) const override { bench.step(ClientCame{client()}); }
  void request(DeviceBench& bench) const override { bench.receive(client(), acoustics("true")); }
  void cancel(DeviceBench& bench) const override { bench.receive(client(), acoustics("false")); }
  void leave(DeviceBench& bench) const override {
    cancel(bench);
    bench.step(ClientGone{client()});
  }

  ReplayedPing recorded() const override {
    const DeviceConfig config = this->config({});
    Settings settings;
    settings.range_m = 15.0;
    Shot shot = make_shot(config, settings, 1491.0);
    add_echoes(test_directions(1, make_job(config, settings, 1491.0).directions), config, 0.0, shot);
    std::vector<std::uint8_t> wire = sonar3d15::encode(shot.range, PacketId::rip2);
    const auto signal = sonar3d15::encode(shot.signal, PacketId::rip2);
    wire.insert(wire.end(), signal.begin(), signal.end());
    ReplayedPing replayed;
    replayed.settings = record_of(shot, 1.2e6, {}).settings;
    replayed.wire = std::move(wire);
    return replayed;
  }

  Peer client() const override { return {sonar3d15::Device::control_channel, {0xC0A80205, 40000}, 0}; }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    return {acoustics("true"),
            sonar3d15::encode(Request{"GET", "/api/v1/integration/status", ""}),
            acoustics("true"),
            sonar3d15::encode(Request{"POST", "/api/v1/integration/acoustics/mode", "\"high-frequency\""}),
            acoustics("true"),
            acoustics("false")};
  }
  bool can_read(std::span<const std::uint8_t> message) const override {
    return decode(message).has_value() || decode_reply(message).has_value();
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.columns = 8;  // so that images take little time
    config.rows = 4;
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    return config;
  }

  sonar3d15::Device device_;
};

}  // namespace

std::unique_ptr<Head> sonar3d15_head(const Mode& mode) {
  return std::make_unique<Sonar3d15Head>(mode);
}

}  // namespace sonard::contract
