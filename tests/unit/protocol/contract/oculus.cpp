// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/device.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace oculus;

class OculusHead final : public Head {
 public:
  explicit OculusHead(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }

  void connect(DeviceBench& bench) const override { bench.step(ClientCame{client()}); }
  void request(DeviceBench& bench) const override { bench.receive(client(), encode(SimpleFire{})); }
  void cancel(DeviceBench& bench) const override { bench.receive(client(), encode(standby())); }
  void leave(DeviceBench& bench) const override { bench.step(ClientGone{client()}); }

  ReplayedPing recorded() const override {
    PlanConfig plan;
    plan.most_ranges = 2;
    PingResult ping = plan_ping(SimpleFire{}, plan).result;
    const std::vector<std::uint8_t> rows(ping.ranges * row_size(ping), 9);
    ping.image = rows;
    const std::vector<std::uint8_t> message = encode(ping, {7892, 1032});
    const PingRecord record = record_of(decode_ping_result(message).value(), message);
    ReplayedPing replayed;
    replayed.settings = record.settings;
    replayed.wire = record.wire;
    return replayed;
  }

  Peer client() const override { return {oculus::Device::stream_channel, {0xC0A80205, 40000}, 0}; }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    return {encode(SimpleFire{}), encode(UserConfig{}), encode(SimpleFire{}), encode(standby())};
  }
  bool can_read(std::span<const std::uint8_t> message) const override {
    Client client;
    client.receive(TimePoint{}, message);
    const ClientStatistics& read = client.statistics();
    return decode_status(message) || (read.messages == 1 && read.bad_messages + read.dropped_bytes == 0);
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.plan.most_ranges = 12;  // rows, so that images take little time
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    return config;
  }
  static SimpleFire standby() {
    SimpleFire fire;
    fire.fire.ping_rate = 5;
    return fire;
  }

  oculus::Device device_;
};

}  // namespace

std::unique_ptr<Head> oculus_head(const Mode& mode) {
  return std::make_unique<OculusHead>(mode);
}

}  // namespace sonard::contract
