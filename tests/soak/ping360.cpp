// SPDX-License-Identifier: Apache-2.0
// A Ping360 and its clients, each from its own address, so that the head must forget them. Angles wrap at
// 400.
#include <utility>

#include "protocol/ping360/client.hpp"
#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace ping360;
using namespace std::chrono_literals;

class Ping360Visitor final : public Visitor {
 public:
  Ping360Visitor(std::uint64_t visit, TimePoint now)
      : peer_{0, {0x7F000001, static_cast<std::uint16_t>(1024 + visit % 60'000)}, 0}, client_(now) {
    const auto samples = static_cast<std::uint16_t>(100 + visit % 3 * 100);
    if (visit % 2 == 0) {
      AutoTransmit scan;
      scan.number_of_samples = samples;
      client_.start(now, scan, 0);
    } else {
      Transducer ping;
      ping.angle = static_cast<std::uint16_t>(visit % 400);
      ping.number_of_samples = samples;
      client_.start(now, ping, 1, 0);
    }
  }

  void hear(TimePoint now, const Outgoing& message) override {
    if (message.peer == peer_) {
      client_.on_bytes(now, message.bytes);
    }
  }
  std::vector<Event> advance(TimePoint now) override {
    client_.advance(now);
    std::vector<Event> said;
    for (std::vector<std::uint8_t>& frame : client_.take_outgoing()) {
      said.emplace_back(BytesReceived{peer_, SharedBytes(std::move(frame))});
    }
    return said;
  }
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  std::vector<SeenPing> take_pings() override {
    require(client_.statistics().bad_frames == 0, "a client can read every frame");
    std::vector<SeenPing> seen;
    for (ReceivedPing& ping : client_.take_pings()) {
      seen.push_back({ping.form.settings.angle, std::move(ping.samples), std::nullopt});
    }
    return seen;
  }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = encode(Command{MotorOff{}});
    half.resize(half.size() / 2);
    return {BytesReceived{peer_, SharedBytes(std::move(half))}};
  }

 private:
  Peer peer_;
  Client client_;
};

class Ping360UnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return 1; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return 400; }
  std::optional<std::chrono::nanoseconds> period() const override { return std::nullopt; }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) override {
    return std::make_unique<Ping360Visitor>(visit, now);
  }
  void check(TimePoint, const Outgoing& message) override {
    require(decode_report(message.bytes).has_value(), "a frame is whole");
  }

 private:
  ping360::Device device_{DeviceConfig{}, 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> ping360_under_soak() {
  return std::make_unique<Ping360UnderSoak>();
}

}  // namespace sonard::soak
