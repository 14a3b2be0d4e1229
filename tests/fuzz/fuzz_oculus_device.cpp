// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of two clients, images, faults and pauses against an Oculus, and its messages against
// the code of a client. Promises, beside those of all heads: every message sent is whole and of the head's
// own protocol; of two clients one is disconnected, the first only after a silence; every record can be
// played.
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/device.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::oculus;
using sonard::Outgoing;
using sonard::Peer;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;

/// Kinds of events. The first two carry bytes, each from its own client: the body of a fire, or a raw piece
/// of stream.
enum Kind {
  byte_kinds = 2,
  come_or_go = 2,
  other_comes = 3,
  image = 4,
  image_failed = 5,
  feed = 6,
  next_due = 7
};

Peer peer_of(int kind) {
  return {Device::stream_channel, {0x7F000001, static_cast<std::uint16_t>(1000 + kind)}, 0};
}

/// The configuration that the first byte of an input selects. Few rows, so that images take little time.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.plan.model = (flags & 0x20U) != 0 ? m370s : (flags & 0x04U) != 0 ? m1200d : m750d;
  config.plan.rescales_high_frequency_gain = (flags & 0x08U) != 0;
  config.plan.reports_sound_speed_used = (flags & 0x10U) != 0;
  config.plan.most_ranges = 3;
  return config;
}

/// A ping as a recording holds it.
sonard::ReplayedPing recorded() {
  SimpleFire fire;
  PlanConfig config;
  config.most_ranges = 2;
  PingResult ping = plan_ping(fire, config).result;
  const std::vector<std::uint8_t> pixels(ping.ranges * row_size(ping), 9);
  ping.image = pixels;
  const std::vector<std::uint8_t> message = encode(ping, {7892, 1032});
  const sonard::PingRecord record = record_of(decode_ping_result(message).value(), message);
  sonard::ReplayedPing played;
  played.settings = record.settings;
  played.wire = record.wire;
  return played;
}

class OculusFuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit OculusFuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return Kind::byte_kinds; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int most_bins() const override { return 3; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case come_or_go:
        if (client_peer_) {
          const Peer gone = *std::exchange(client_peer_, std::nullopt);
          step(sonard::ClientGone{gone});
        } else {
          takes_place(peer_of(0));
          step(sonard::ClientCame{peer_of(0)});
        }
        break;
      case other_comes:
        if (client_peer_) {
          const Peer other = *client_peer_ == peer_of(0) ? peer_of(1) : peer_of(0);
          step(sonard::ClientCame{other});
          require(last().disconnect.size() == 1, "of two clients one is sent away");
          step(sonard::ClientGone{last().disconnect.front()});
        }
        break;
      case image:
        answer_job(true);
        break;
      case image_failed:
        answer_job(false);
        break;
      case feed:
        step(sonard::PingFed{recorded()});
        break;
      case next_due:
        begin_next();
        break;
      default:
        receive(event);
    }
  }

  void takes_place(const Peer& client) {
    client_peer_ = client;
    came_ = now();
    client_.connected();
  }

  void receive(const Event& event) {
    std::vector<std::uint8_t> bytes = event.datagram;
    if (!event.as_is) {
      const std::vector<std::uint8_t> fire = encode(SimpleFire{});
      bytes.insert(bytes.begin(), fire.begin(), fire.begin() + header_size);
      bytes.resize(fire.size());
    }
    step(sonard::BytesReceived{peer_of(event.kind), SharedBytes(bytes)});
  }

  void check_message(const Outgoing& outgoing) override {
    if (outgoing.to == Outgoing::To::everybody) {
      require(decode_status(outgoing.bytes).has_value(), "a status is whole");
      return;
    }
    require(client_peer_ == outgoing.peer, "messages are for the client");
    const ClientStatistics before = client_.statistics();
    client_.receive(now(), outgoing.bytes);
    const ClientStatistics& after = client_.statistics();
    require(after.messages == before.messages + 1, "one whole message at a time");
    require(after.bad_messages == 0 && after.dropped_bytes == 0, "a head speaks its own protocol");
    require(after.pings_missed == 0, "numbers of pings count up");
  }

  void check_job(const PingJob& job) const override {
    require(client_peer_.has_value(), "nobody wants it");
    require(job.bins() <= 3, "a job can be rendered");
    require(job.native_bin_m > 0.0 && job.native_bin_m < 1000.0, "its rows have a length");
    require(job.beams == 256 || job.beams == 512, "it has beams");
    require(job.amplitude_exponent > 0.0 && job.amplitude_exponent <= 1.0, "it has a gamma");
    require(job.gain_percent >= 0.0 && job.gain_percent <= 100.0, "it has a gain");
    require(job.transmit_time <= now(), "a job is not ahead of its time");
  }

  void check_record(const sonard::PingRecord& record) const override {
    require(recorded_form(record.wire).has_value(), "a record can be played");
  }

  void stepped(const sonard::Event& event) override {
    const auto* other = std::get_if<sonard::ClientCame>(&event);
    if (other != nullptr && client_peer_ && std::ranges::count(last().disconnect, *client_peer_) > 0) {
      require(now() - came_ >= Device::most_silence, "a client that has just come stays");
      takes_place(other->who);
    }
  }

  DeviceConfig config_;
  Device device_{config_, {}};
  Client client_;
  std::optional<Peer> client_peer_;
  TimePoint came_{};  ///< time at which the client came
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<OculusFuzzer>(flags);
}
