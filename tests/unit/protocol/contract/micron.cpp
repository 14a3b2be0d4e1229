// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "tests/support/messages.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace micron;
using std::chrono::seconds;

class MicronHead final : public Head {
 public:
  explicit MicronHead(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  void connect(DeviceBench& bench) const override {
    bench.run_for(seconds{10});
    say(bench, all_round());
    bench.run_for(seconds{2});
  }
  void request(DeviceBench& bench) const override { say(bench, SendData{}); }
  void cancel(DeviceBench& bench) const override {
    say(bench, Reboot{});
    connect(bench);
  }
  void leave(DeviceBench& bench) const override { bench.step(ClientGone{}); }

  ReplayedPing recorded() const override {
    HeadData line;
    line.status = head_status_bits::eight_bit;
    line.control = 0x2301;
    line.ad_interval = 100;
    line.bearing = 1000;
    ReplayedPing ping;
    ping.settings = {.bins = 30, .beams = 1, .bin_m = 100 * 640e-9 * 740.0, .sound_speed_mps = 1480.0};
    ping.bearing_rad = 2.16;
    ping.wire = recorded_wire(line, default_head_node);
    return ping;
  }

  Peer client() const override { return {}; }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    std::vector<std::vector<std::uint8_t>> messages{encode(all_round(), default_head_node)};
    for (const char* name :
         {"send_data", "send_data", "send_data", "send_data", "send_data", "send_version", "head_command_ros",
          "head_command_rock", "head_command_uxv", "gain", "reverse", "send_bb_user", "reboot"}) {
      messages.push_back(testing::message_bytes("micron", name));
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
    config.half_duplex = (mode.options & 1) != 0;
    config.requests_survive_head_command = (mode.options & 2) != 0;
    config.nibble_order = (mode.options & 4) != 0 ? NibbleOrder::low_first : NibbleOrder::high_first;
    return config;
  }
  static HeadCommand all_round() {
    HeadCommand command;
    command.control = 0x2307;
    command.step = 32;
    command.bins = 20;
    return command;
  }
  void say(DeviceBench& bench, const Command& command) const {
    bench.receive(client(), encode(command, default_head_node));
  }

  micron::Device device_;
};

}  // namespace

std::unique_ptr<Head> micron_head(const Mode& mode) {
  return std::make_unique<MicronHead>(mode);
}

}  // namespace sonard::contract
