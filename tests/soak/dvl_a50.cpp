// SPDX-License-Identifier: Apache-2.0
// A DVL and its clients, one after another. Its reports have no number: the visitor counts them.
#include <utility>

#include "protocol/dvl_a50/client.hpp"
#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace dvl_a50;
using namespace std::chrono_literals;

/// One range mode, so that all records have the same range.
DeviceConfig soak_config() {
  DeviceConfig config;
  config.search_interval = 100ms;
  config.processing_delay = 0ns;
  config.settings.range_mode = "=4";
  return config;
}

/// The samples of the record of a report.
std::vector<std::uint8_t> samples_of(const Velocity& report) {
  const DeviceConfig config = soak_config();
  const PingJob job = make_job(plan_ping(std::nullopt, config, config.settings), config);
  return record_of(report, job.range_m(), job.sound_speed_mps).samples;
}

class DvlVisitor final : public Visitor {
 public:
  explicit DvlVisitor(std::uint64_t visit)
      : peer_{json_channel, {0x7F000001, static_cast<std::uint16_t>(1024 + visit % 60'000)}, 0} {}

  std::vector<Event> come() override { return {ClientCame{peer_}}; }
  void hear(TimePoint, const Outgoing& message) override {
    if (message.peer == peer_) {
      client_.on_bytes(message.bytes);
    }
  }
  std::vector<Event> advance(TimePoint) override {
    if (std::exchange(asked_, true)) {
      return {};
    }
    const std::string text = command_text("get_config") + command_text("reset_dead_reckoning");
    return {BytesReceived{peer_, SharedBytes(std::vector<std::uint8_t>(text.begin(), text.end()))}};
  }
  std::optional<TimePoint> next_deadline() const override { return std::nullopt; }
  std::vector<SeenPing> take_pings() override {
    std::vector<SeenPing> seen;
    for (const Report& report : client_.take()) {
      if (const auto* const velocity = std::get_if<Velocity>(&report)) {
        seen.push_back({count_++, samples_of(*velocity), std::nullopt});
      }
    }
    require(client_.unreadable() == 0, "a client can read every message");
    return seen;
  }
  std::vector<Event> leave() override {
    const std::string half = "{\"command\":";
    return {BytesReceived{peer_, SharedBytes(std::vector<std::uint8_t>(half.begin(), half.end()))},
            ClientGone{peer_}};
  }

 private:
  Peer peer_;
  Client client_;
  bool asked_ = false;
  std::uint64_t count_ = 0;
};

class DvlUnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return 1; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return std::uint64_t{1} << 32; }
  std::optional<std::chrono::nanoseconds> period() const override { return std::nullopt; }
  std::vector<std::uint8_t> made_of(const std::vector<std::uint8_t>& image) const override {
    const DeviceConfig config = soak_config();
    Noise noise(1);
    const PingPlan plan = plan_ping(std::nullopt, config, config.settings);
    const auto ranges_m = beam_ranges_m(echoes_of(image, beam_grid()));
    return samples_of(measure(*ranges_m, {}, plan, config, config.settings, noise).report);
  }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint) override {
    return std::make_unique<DvlVisitor>(visit);
  }
  void check(TimePoint, const Outgoing& message) override {
    require(message.bytes.size() < 2048, "a message is short");
  }

 private:
  dvl_a50::Device device_{soak_config(), 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> dvl_a50_under_soak() {
  return std::make_unique<DvlUnderSoak>();
}

}  // namespace sonard::soak
