// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {
namespace {

using namespace gemini;
using std::chrono::seconds;

constexpr Ipv4 head_address = 0xC0A802C9;  // 192.168.2.201

class GeminiHead final : public Head {
 public:
  explicit GeminiHead(const Mode& mode) : device_(config(mode), TimePoint{}) {}

  sonard::Device& device() override { return device_; }
  const PingCounters& counters() const override { return device_.counters(); }
  int beams() const override { return beam_count; }

  void connect(DeviceBench& bench) const override { say(bench, StatusRequest{}); }
  void request(DeviceBench& bench) const override { say(bench, single_ping()); }
  void cancel(DeviceBench& bench) const override {
    say(bench, Reboot{});
    bench.run_for(seconds{6});
    connect(bench);
  }
  void leave(DeviceBench& bench) const override { bench.run_for(seconds{3}); }

  ReplayedPing recorded() const override {
    ReplayedPing ping;
    ping.settings = {.bins = 40,
                     .beams = beam_count,
                     .bin_m = 4 * 1480.5 / (2 * line_rate_hz),
                     .sound_speed_mps = 1480.5,
                     .gain_percent = 31.5,
                     .frequency_hz = carrier_hz};
    return ping;
  }

  Peer client() const override { return {0, {0xC0A80205, client_port}, head_address}; }
  std::vector<std::vector<std::uint8_t>> messages() const override {
    return {encode(Command{single_ping()}), encode(Command{RetryRequest{}}), encode(Command{single_ping()}),
            encode(Command{StatusRequest{}}), encode(Command{Reboot{}})};
  }
  bool records_broken_pings() const override { return true; }
  bool can_read(std::span<const std::uint8_t> message) const override {
    return decode_report(message).has_value();
  }

 private:
  static DeviceConfig config(const Mode& mode) {
    DeviceConfig config;
    config.accept_id_zero = true;
    config.alternate_address = head_address;
    config.plays_back = mode.plays_back;
    config.simulated_time = mode.simulated_time;
    return config;
  }
  static PingConfig single_ping() {
    PingConfig config;
    config.run_mode = static_cast<std::uint16_t>(RunMode::single);
    config.ext_mode = ext_bits::eight_bit | ext_bits::ping_out_of_water;
    config.end_range = 64;
    return config;
  }
  void say(DeviceBench& bench, const Command& command) const { bench.receive(client(), encode(command)); }

  gemini::Device device_;
};

}  // namespace

std::unique_ptr<Head> gemini_head(const Mode& mode) {
  return std::make_unique<GeminiHead>(mode);
}

}  // namespace sonard::contract
