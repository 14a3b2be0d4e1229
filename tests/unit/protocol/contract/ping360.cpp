// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace ping360;

class Ping360Head final : public Head {
 public:
  explicit Ping360Head(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  void connect(DeviceBench& bench) const override { say(bench, GeneralRequest{4}); }
  void request(DeviceBench& bench) const override { say(bench, ping_ahead()); }
  void cancel(DeviceBench& bench) const override { say(bench, MotorOff{}); }
  void leave(DeviceBench& bench) const override { bench.step(ClientGone{client()}); }

  ReplayedPing recorded() const override {
    Transducer command = ping_ahead();
    command.sample_period = 400;
    command.number_of_samples = 30;
    ReplayedPing ping;
    ping.settings = {.bins = 30, .beams = 1, .bin_m = 10e-6 * 740.0, .sound_speed_mps = 1480.0};
    ping.bearing_rad = 1.25;
    ping.wire = recorded_wire(form_of(command), default_device_id);
    return ping;
  }

  Peer client() const override { return {0, {0x7F000001, 4000}, 0}; }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    AutoTransmit scan;
    scan.number_of_samples = 200;
    scan.stop_angle = 399;
    return {encode(ping_ahead()), encode(GeneralRequest{4}), encode(scan), encode(MotorOff{})};
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    return config;
  }
  static Transducer ping_ahead() {
    Transducer command;
    command.number_of_samples = 200;
    return command;
  }
  void say(DeviceBench& bench, const Command& command) const { bench.receive(client(), encode(command)); }

  ping360::Device device_;
};

}  // namespace

std::unique_ptr<Head> ping360_head(const Mode& mode) {
  return std::make_unique<Ping360Head>(mode);
}

}  // namespace sonard::contract
