// SPDX-License-Identifier: Apache-2.0
// A Gemini 720i and its clients. Ping IDs wrap at 256; stamps are 64-bit microseconds.
#include <utility>
#include <variant>

#include "protocol/gemini/client.hpp"
#include "protocol/gemini/codec.hpp"
#include "protocol/gemini/device.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace gemini;
using namespace std::chrono_literals;

constexpr Ipv4 head_address = 0xC0A802C9;  // 192.168.2.201
constexpr Ipv4 first_client = 0xC0A80205;  // 192.168.2.5
constexpr std::uint64_t clients = 100;
constexpr std::chrono::milliseconds period_of_pings = 100ms;

class GeminiVisitor final : public Visitor {
 public:
  GeminiVisitor(std::uint64_t visit, TimePoint now)
      : peer_{0, {static_cast<Ipv4>(first_client + visit % clients), client_port}, head_address},
        client_(ClientConfig{}) {
    PingConfig config;
    config.run_mode = static_cast<std::uint16_t>(RunMode::continuous);
    config.ext_mode = ext_bits::eight_bit | ext_bits::ping_out_of_water;
    config.end_range = static_cast<std::uint16_t>(4 + visit % 3 * 6);
    config.interping_us = static_cast<std::uint32_t>(period_of_pings / 1us);
    client_.start(now, config, 0);
  }

  void hear(TimePoint now, const Outgoing& message) override {
    if (message.to == Outgoing::To::everybody || message.peer.remote.address == peer_.remote.address) {
      client_.on_datagram(now, message.bytes);
    }
  }
  std::vector<Event> advance(TimePoint now) override {
    client_.advance(now);
    std::vector<Event> said;
    for (ClientDatagram& datagram : client_.take_outgoing()) {
      said.emplace_back(BytesReceived{peer_, SharedBytes(std::move(datagram.bytes))});
    }
    return said;
  }
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  std::vector<SeenPing> take_pings() override {
    std::vector<SeenPing> seen;
    for (ReceivedPing& ping : client_.take_pings()) {
      require(ping.complete(), "a ping has all its lines");
      const auto stamp_ns = static_cast<std::int64_t>(ping.head.transmit_time_us) * 1000;
      seen.push_back({ping.head.ping_id, std::move(ping.samples.u8), SeenPing::Stamp{stamp_ns, 1000}});
    }
    return seen;
  }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = encode(Command{StatusRequest{}});
    half.resize(half.size() / 2);
    return {BytesReceived{peer_, SharedBytes(std::move(half))}};
  }

 private:
  Peer peer_;
  Client client_;
};

class GeminiUnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return beam_count; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return 256; }
  std::optional<std::chrono::nanoseconds> period() const override { return period_of_pings; }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint now) override {
    return std::make_unique<GeminiVisitor>(visit, now);
  }
  void check(TimePoint now, const Outgoing& message) override {
    if (message.to != Outgoing::To::everybody) {
      return;
    }
    const auto report = decode_report(message.bytes);
    const Status* status = report ? std::get_if<Status>(&*report) : nullptr;
    require(status != nullptr, "what goes to everybody is a status");
    require(status->clock_us == static_cast<std::uint64_t>(now / 1us), "a status tells the time");
    require(now == statuses_++ * status_period, "statuses keep their period");
  }

 private:
  static constexpr std::chrono::nanoseconds status_period = DeviceConfig{}.status_period;

  static DeviceConfig config() {
    DeviceConfig config;
    config.alternate_address = head_address;
    return config;
  }

  gemini::Device device_{config(), 0ns};
  std::int64_t statuses_ = 0;
};

}  // namespace

std::unique_ptr<HeadUnderSoak> gemini_under_soak() {
  return std::make_unique<GeminiUnderSoak>();
}

}  // namespace sonard::soak
