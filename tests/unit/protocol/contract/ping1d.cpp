// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/recorded_form.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace ping1d;

constexpr int serial_channel = 1;

class Ping1dHead final : public Head {
 public:
  explicit Ping1dHead(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  /// The head pings as long as it has a client, unless the client has disabled it.
  void connect(DeviceBench& bench) const override { say(bench, SetPingEnable{0}); }
  void request(DeviceBench& bench) const override {
    say(bench, SetPingEnable{1});
    say(bench, ContinuousStart{1300});
  }
  void cancel(DeviceBench& bench) const override { say(bench, SetPingEnable{0}); }
  void leave(DeviceBench& bench) const override { bench.step(ClientGone{client()}); }

  ReplayedPing recorded() const override {
    ReplayedPing ping;
    ping.settings = {.bins = 50, .beams = 1, .bin_m = 0.04, .sound_speed_mps = 1480.0};
    ping.wire = record_of({.distance_mm = 1234, .scan_length_mm = 2000}, {}, 1480.0, default_device_id).wire;
    return ping;
  }

  Peer client() const override { return {0, {0x7F000001, 4000}, 0}; }
  std::vector<Peer> clients() const override {
    return {client(), {0, {0x7F000001, 4001}, 0}, {serial_channel, {}, 0}};
  }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    return {encode(SetPingEnable{1}),     encode(ContinuousStart{1300}), encode(ContinuousStart{1211}),
            encode(GeneralRequest{1300}), encode(SetPingInterval{20}),   encode(SetModeAuto{0}),
            encode(SetRange{0, 5000}),    encode(SetGainSetting{9}),     encode(SetDeviceId{43}),
            encode(GotoBootloader{})};
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
      config.acknowledges = (mode.options & 2) == 0;
      config.refuses_silently_in_auto = (mode.options & 4) != 0;
      config.time_scale = mode.options % 3;
      config.bootloader_silence = std::chrono::milliseconds(mode.options);
    }
    return config;
  }
  void say(DeviceBench& bench, const Command& command) const { bench.receive(client(), encode(command)); }

  ping1d::Device device_;
};

}  // namespace

std::unique_ptr<Head> ping1d_head(const Mode& mode) {
  return std::make_unique<Ping1dHead>(mode);
}

}  // namespace sonard::contract
