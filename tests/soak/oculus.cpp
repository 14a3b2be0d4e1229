// SPDX-License-Identifier: Apache-2.0
// An Oculus and its clients, one after another. Stamps of version 1 are 32-bit nanoseconds, which wrap every
// 4.3 s; stamps of version 2 are seconds in a double. Ping numbers continue across clients.
#include <cmath>
#include <utility>

#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/device.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace oculus;
using namespace std::chrono_literals;

Peer peer_of(std::uint64_t visit) {
  return {oculus::Device::stream_channel, {0xC0A80205, static_cast<std::uint16_t>(1024 + visit % 60'000)}, 0};
}

SeenPing::Stamp stamp_of(const PingResult& ping) {
  if (!ping.fire.extension) {
    return {ping.start_time_ns, 1, std::int64_t{1} << 32};
  }
  return {std::llround(ping.start_time_s * 1e9), 100,
          0};  // a double resolves a day in seconds to better than 0.1 ns
}

class OculusVisitor final : public Visitor {
 public:
  explicit OculusVisitor(std::uint64_t visit) : peer_(peer_of(visit)) {
    fire_.fire.flags = fire_flags::range_in_metres | fire_flags::simple_result;
    fire_.fire.range = 0.5 + 0.25 * static_cast<double>(visit % 3);
    if (visit % 2 == 1) {
      fire_.version = 2;
      fire_.extension.emplace();
    }
    client_.connected();
  }

  std::vector<Event> come() override { return {ClientCame{peer_}}; }
  void hear(TimePoint now, const Outgoing& message) override {
    if (message.to == Outgoing::To::peer && message.peer == peer_) {
      client_.receive(now, message.bytes);
    }
  }
  std::vector<Event> advance(TimePoint) override {
    if (std::exchange(fired_, true)) {
      return {};
    }
    return {BytesReceived{peer_, SharedBytes(encode(fire_))}};
  }
  std::optional<TimePoint> next_deadline() const override { return std::nullopt; }
  std::vector<SeenPing> take_pings() override {
    const ClientStatistics& statistics = client_.statistics();
    require(statistics.bad_messages == 0 && statistics.dropped_bytes == 0, "a client can read every message");
    client_.take_logs();
    std::vector<SeenPing> seen;
    for (const ReceivedPing& ping : client_.take_pings()) {
      const auto image = ping.result.image;
      seen.push_back({ping.result.ping_id, {image.begin(), image.end()}, stamp_of(ping.result)});
    }
    return seen;
  }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = encode(fire_);
    half.resize(half.size() / 2);
    return {BytesReceived{peer_, SharedBytes(std::move(half))}, ClientGone{peer_}};
  }

 private:
  Peer peer_;
  SimpleFire fire_;
  bool fired_ = false;
  Client client_;
};

class OculusUnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return 256; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return std::uint64_t{1} << 32; }
  std::optional<std::chrono::nanoseconds> period() const override { return 100ms; }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint) override {
    return std::make_unique<OculusVisitor>(visit);
  }
  void check(TimePoint, const Outgoing& message) override {
    if (message.to == Outgoing::To::everybody) {
      require(decode_status(message.bytes).has_value(), "a status is whole");
    }
  }

 private:
  static DeviceConfig config() {
    DeviceConfig config;
    config.plan.most_ranges = 12;  // rows, so that an image has 3 kB
    return config;
  }

  oculus::Device device_{config(), 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> oculus_under_soak() {
  return std::make_unique<OculusUnderSoak>();
}

}  // namespace sonard::soak
