// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace ping360;

constexpr int serial_channel = 1;

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
  std::vector<Peer> clients() const override {
    return {client(), {0, {0x7F000001, 4001}, 0}, {serial_channel, {}, 0}};
  }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    AutoTransmit scan;
    scan.number_of_samples = 200;
    scan.stop_angle = 399;
    std::vector<std::vector<std::uint8_t>> messages{encode(ping_ahead()), encode(scan)};
    for (const char* name :
         {"transducer", "transducer_brping", "transducer_pnarvor", "auto_transmit", "request_device_data",
          "motor_off", "set_device_id", "device_data", "request_device_information", "reset"}) {
      messages.push_back(testing::message_bytes("ping360", name));
    }
    return messages;
  }
  bool can_read(std::span<const std::uint8_t> message) const override {
    return decode_report(message).has_value();
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    if (mode.options != 0) {
      config.serial_channel = serial_channel;
      config.fan_out = (mode.options & 1) != 0 ? FanOut::all : FanOut::requester;
      config.signed_scan_angles = (mode.options & 2) != 0;
      config.clamps_scan_to_stop = (mode.options & 4) != 0;
      config.time_scale = mode.options % 3;
      config.reset_silence = std::chrono::milliseconds(mode.options);
    }
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
