// SPDX-License-Identifier: Apache-2.0
// A Ping1D and its clients, each from its own address, so that the head must forget them.
#include <utility>

#include "protocol/ping1d/client.hpp"
#include "protocol/ping1d/codec.hpp"
#include "protocol/ping1d/device.hpp"
#include "protocol/ping1d/echo.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace ping1d;
using namespace std::chrono_literals;

class Ping1dVisitor final : public Visitor {
 public:
  Ping1dVisitor(std::uint64_t visit, TimePoint now)
      : peer_{0, {0x7F000001, static_cast<std::uint16_t>(1024 + visit % 60'000)}, 0}, client_(now) {
    client_.start(now,
                  {SetPingEnable{1}, SetPingInterval{static_cast<std::uint16_t>(visit % 3 * 50)},
                   SetModeAuto{static_cast<std::uint8_t>(visit % 2)}},
                  0);
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
      seen.push_back({ping.measured.ping_number, std::move(ping.profile), std::nullopt});
    }
    return seen;
  }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = encode(Command{SetPingEnable{1}});
    half.resize(half.size() / 2);
    return {BytesReceived{peer_, SharedBytes(std::move(half))}};
  }

 private:
  Peer peer_;
  Client client_;
};

class Ping1dUnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return 1; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return std::uint64_t{1} << 32; }
  std::optional<std::chrono::nanoseconds> period() const override { return std::nullopt; }
  /// Any scan from 0 divides its samples into the same points.
  std::vector<std::uint8_t> made_of(const std::vector<std::uint8_t>& image) const override {
    return find_echo(amplitudes({.number = 0, .u8 = image, .u16 = {}}), Scan{}, DeviceConfig{}.points, 500.0)
        .profile;
  }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) override {
    return std::make_unique<Ping1dVisitor>(visit, now);
  }
  void check(TimePoint, const Outgoing& message) override {
    require(decode_report(message.bytes).has_value(), "a frame is whole");
  }

 private:
  ping1d::Device device_{DeviceConfig{}, 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> ping1d_under_soak() {
  return std::make_unique<Ping1dUnderSoak>();
}

}  // namespace sonard::soak
