// SPDX-License-Identifier: Apache-2.0
// A Sonar 3D-15 and its clients, one after another. Odd ones switch acoustics off when they leave. Numbers of
// shots continue across clients.
#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/device.hpp"
#include "protocol/sonar3d15/http.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {
namespace {

using namespace sonar3d15;
using namespace std::chrono_literals;

DeviceConfig config() {
  DeviceConfig config;
  config.columns = 5;  // pixels, so that an image has few bytes
  config.rows = 3;
  return config;
}

Peer peer_of(std::uint64_t visit) {
  return {
      sonar3d15::Device::control_channel, {0xC0A80205, static_cast<std::uint16_t>(1024 + visit % 60'000)}, 0};
}

std::vector<std::uint8_t> acoustics(const char* on) {
  return encode(Request{"POST", "/api/v1/integration/acoustics/enabled", on});
}

class Sonar3d15Visitor final : public Visitor {
 public:
  explicit Sonar3d15Visitor(std::uint64_t visit) : visit_(visit) {}

  std::vector<Event> come() override { return {ClientCame{peer()}}; }
  void hear(TimePoint, const Outgoing& message) override {
    if (message.peer.channel != sonar3d15::Device::image_channel) {
      const auto reply = decode_reply({message.bytes.data(), message.bytes.size()});
      require(reply && reply->status == 204, "the head obeys");
      return;
    }
    const auto image = decode({message.bytes.data(), message.bytes.size()});
    require(image.has_value(), "a client can read every image");
    if (const auto* const range = std::get_if<RangeImage>(&*image)) {
      range_ = *range;
    } else if (const auto* const signal = std::get_if<BitmapImageGreyscale8>(&*image)) {
      require(range_ && range_->header().sequence_id() == signal->header().sequence_id(),
              "a signal follows its ranges");
      take({*range_, *signal});
    }
  }
  std::vector<Event> advance(TimePoint) override {
    return std::exchange(asked_, true) ? std::vector<Event>{} : std::vector{said(acoustics("true"))};
  }
  std::optional<TimePoint> next_deadline() const override { return std::nullopt; }
  std::vector<SeenPing> take_pings() override { return std::exchange(seen_, {}); }
  std::vector<Event> leave() override {
    std::vector<std::uint8_t> half = acoustics("true");
    half.resize(half.size() / 2);
    std::vector<Event> events;
    if (visit_ % 2 == 1) {
      events.push_back(said(acoustics("false")));
    }
    events.push_back(said(std::move(half)));
    events.emplace_back(ClientGone{peer()});
    return events;
  }

 private:
  Peer peer() const { return peer_of(visit_); }
  Event said(std::vector<std::uint8_t> bytes) const {
    return BytesReceived{peer(), SharedBytes(std::move(bytes))};
  }
  void take(const Shot& shot) {
    const Header& header = shot.range.header();
    seen_.push_back(
        {header.sequence_id(), record_of(shot, 0.0, {}).samples,
         SeenPing::Stamp{header.timestamp().seconds() * 1'000'000'000 + header.timestamp().nanos(), 1, 0}});
  }

  std::uint64_t visit_;
  bool asked_ = false;
  std::optional<RangeImage> range_;
  std::vector<SeenPing> seen_;
};

class Sonar3d15UnderSoak final : public HeadUnderSoak {
 public:
  sonard::Device& device() override { return device_; }
  int beams() const override { return 1; }
  std::uint64_t id_step() const override { return 1; }
  std::uint64_t id_modulus() const override { return std::uint64_t{1} << 32; }
  std::optional<std::chrono::nanoseconds> period() const override { return 200ms; }
  std::vector<std::uint8_t> made_of(const std::vector<std::uint8_t>& image) const override {
    Settings settings;
    settings.least_range_m = config_.least_range_m;
    settings.range_m = config_.range_m;
    Shot shot = make_shot(config_, settings, config_.automatic_sound_speed_mps);
    const PingJob job = make_job(config_, settings, config_.automatic_sound_speed_mps);
    add_echoes(echoes_of(image, job.directions), config_, config_.least_range_m, shot);
    return record_of(shot, 0.0, {}).samples;
  }
  std::unique_ptr<Visitor> visitor(std::uint64_t visit, TimePoint) override {
    return std::make_unique<Sonar3d15Visitor>(visit);
  }
  void check(TimePoint, const Outgoing& message) override {
    require(message.to == Outgoing::To::peer, "nothing is broadcast");
  }

 private:
  const DeviceConfig config_ = config();
  sonar3d15::Device device_{config_, 0ns};
};

}  // namespace

std::unique_ptr<HeadUnderSoak> sonar3d15_under_soak() {
  return std::make_unique<Sonar3d15UnderSoak>();
}

}  // namespace sonard::soak
