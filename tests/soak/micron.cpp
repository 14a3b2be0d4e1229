// SPDX-License-Identifier: Apache-2.0
// A Micron and its clients, on one line. Bearings wrap at 6400. The head's clock counts 32-bit milliseconds;
// here it wraps an hour after the start.
#include <utility>
#include <variant>

#include "protocol/micron/client.hpp"
#include "protocol/micron/codec.hpp"
#include "protocol/micron/device.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace micron;
using namespace std::chrono_literals;

constexpr std::uint8_t step = 32;
/// The client's clock at its first request of a line.
constexpr std::uint32_t an_hour_before_it_wraps_ms = UINT32_MAX - 3'600'000 + 1;

class MicronVisitor final : public Visitor {
 public:
  MicronVisitor(std::uint64_t visit, TimePoint now) : client_(ClientConfig{}, now) {
    HeadCommand parameters;
    parameters.control = 0x2307;  // full turns, clockwise, 8 bits
    parameters.step = step;
    parameters.bins = static_cast<std::uint16_t>(20 + visit % 3 * 40);
    client_.start(now, parameters, 0);
  }

  void hear(TimePoint now, const Outgoing& message) override { client_.on_bytes(now, message.bytes); }
  std::vector<Event> advance(TimePoint now) override {
    client_.advance(now);
    std::vector<Event> said;
    for (std::vector<std::uint8_t>& frame : client_.take_outgoing()) {
      said.emplace_back(BytesReceived{{}, SharedBytes(std::move(frame))});
    }
    return said;
  }
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  std::vector<SeenPing> take_pings() override {
    require(client_.statistics().bad_frames == 0, "a client can read every frame");
    std::vector<SeenPing> seen;
    for (ReceivedLine& line : client_.take_lines()) {
      seen.push_back({line.head.bearing, std::move(line.bins), std::nullopt});
    }
    return seen;
  }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = encode(Command{SendData{}});
    half.resize(half.size() / 2);
    return {BytesReceived{{}, SharedBytes(std::move(half))}, ClientGone{}};
  }

 private:
  Client client_;
};

class MicronUnderSoak final : public HeadUnderSoak {
 public:
  MicronUnderSoak() {
    device_.step(0ns, BytesReceived{{}, SharedBytes(encode(Command{SendData{an_hour_before_it_wraps_ms}}))});
  }
  sonard::Device& device() override { return device_; }
  int beams() const override { return 1; }
  std::uint64_t id_step() const override { return step; }
  std::uint64_t id_modulus() const override { return 6400; }
  std::optional<std::chrono::nanoseconds> period() const override { return std::nullopt; }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) override {
    return std::make_unique<MicronVisitor>(visit, now);
  }
  void check(TimePoint now, const Outgoing& message) override {
    const auto report = decode_report(message.bytes);
    require(report.has_value(), "a frame is whole");
    if (const Alive* alive = std::get_if<Alive>(&*report)) {
      const auto time_ms = static_cast<std::uint32_t>(an_hour_before_it_wraps_ms + now / 1ms);
      require(alive->time_ms == time_ms, "an alive tells the time");
    }
  }

 private:
  micron::Device device_{DeviceConfig{}, 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> micron_under_soak() {
  return std::make_unique<MicronUnderSoak>();
}

}  // namespace sonard::soak
