// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of two clients, images, faults and pauses against a Sonar 3D-15. Promises, beside
// those of all heads: a client can read every reply and image; both images of a shot have the same header and
// the same pixels without echoes; nothing is sent while acoustics are off; every record can be played.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/sonar3d15/codec.hpp"
#include "protocol/sonar3d15/device.hpp"
#include "protocol/sonar3d15/http.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::sonar3d15;
using sonard::Outgoing;
using sonard::Peer;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::fuzz::Event;
using sonard::fuzz::require;

/// Kinds of events. The first two carry bytes, each from its own client: a raw piece of its stream, or the
/// body of a request, whose path the first byte chooses.
enum Kind { byte_kinds = 2, come_or_go = 2, image = 4, image_failed = 5, feed = 6, next_due = 7 };

constexpr std::array<const char*, 14> paths{"about",
                                            "acoustics/enabled",
                                            "acoustics/mode",
                                            "acoustics/range",
                                            "acoustics/salinity",
                                            "acoustics/speed_of_sound",
                                            "output/imu-batch/enabled",
                                            "status",
                                            "temperature",
                                            "time/manual",
                                            "time/ntp",
                                            "time/ntp/force-sync",
                                            "time/status",
                                            "udp"};

Peer peer_of(int kind) {
  return {Device::control_channel, {0x7F000001, static_cast<std::uint16_t>(1000 + kind)}, 0};
}

/// The configuration that the first byte of an input selects. Few pixels, so that images take little time.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.acoustics = (flags & 0x04U) != 0;
  config.ntp_synced = (flags & 0x08U) != 0;
  if ((flags & 0x10U) != 0) {
    config.release = {1, 5, 1};
  }
  config.temperature_c = (flags & 0x20U) != 0 ? 60.0 : 31.5;
  config.columns = 3;
  config.rows = 2;
  return config;
}

/// A shot as a recording holds it.
sonard::ReplayedPing recorded() {
  const DeviceConfig config = config_of(0);
  Settings settings;
  settings.range_m = 4.0;
  Shot shot = make_shot(config, settings, 1491.0);
  add_echoes({3, 2, std::vector<float>(6, 2.0F), std::vector<float>(6, 1e-4F)}, config, 0.0, shot);
  sonard::ReplayedPing played;
  played.settings = record_of(shot, 1.2e6, {}).settings;
  played.wire = encode(shot.range, PacketId::rip2);
  const auto signal = encode(shot.signal, PacketId::rip1);
  played.wire.insert(played.wire.end(), signal.begin(), signal.end());
  return played;
}

class Sonar3d15Fuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit Sonar3d15Fuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return Kind::byte_kinds; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int beams() const override { return 3; }
  int most_bins() const override { return fan_bins; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case come_or_go:
        there_ = !there_;
        for (int kind = 0; kind < Kind::byte_kinds; ++kind) {
          there_ ? step(sonard::ClientCame{peer_of(kind)}) : step(sonard::ClientGone{peer_of(kind)});
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

  void receive(const Event& event) {
    std::vector<std::uint8_t> bytes = event.datagram;
    if (!event.as_is && !bytes.empty()) {
      const std::string path = std::string("/api/v1/integration/") + paths[bytes.front() % paths.size()];
      const bool post = bytes.front() < 128;
      bytes = encode(Request{post ? "POST" : "GET", path, std::string(bytes.begin() + 1, bytes.end())});
    }
    step(sonard::BytesReceived{peer_of(event.kind), SharedBytes(bytes)});
  }

  void check_message(const Outgoing& outgoing) override {
    if (outgoing.peer.channel == Device::control_channel) {
      const auto reply = decode_reply(outgoing.bytes);
      require(reply.has_value(), "a reply is whole");
      require(reply->body.empty() == (reply->status == 204) || reply->status >= 400, "only 204 has no body");
      return;
    }
    require(!last().nobody_there, "acoustics off silences everything");
    const auto message = decode(outgoing.bytes);
    require(message.has_value() && !std::holds_alternative<Unknown>(*message),
            "a client can read every image");
    if (const auto* const range = std::get_if<RangeImage>(&*message)) {
      range_ = *range;
    } else if (const auto* const signal = std::get_if<BitmapImageGreyscale8>(&*message)) {
      require(range_ && range_->header().SerializeAsString() == signal->header().SerializeAsString(),
              "one header");
      for (int i = 0; i < range_->image_pixel_data_size(); ++i) {
        const bool empty = signal->image_pixel_data()[static_cast<std::size_t>(i)] == '\0';
        require((range_->image_pixel_data(i) == 0) == empty, "no echo in both images");
      }
      range_.reset();
    }
  }

  void check_job(const PingJob& job) const override {
    require(!last().nobody_there, "nobody wants it");
    require(config_.temperature_c < 60.0, "the head is too hot");
    require(job.directions.any() != job.record.has_value(), "it has directions, or is recorded");
    require(job.range_m() > 0.0 && job.range_m() < 100.0, "it has a range");
    require(job.transmit_time <= now(), "a job is not ahead of its time");
  }

  void check_record(const sonard::PingRecord& record) const override {
    require(recorded_form(record.wire).has_value(), "a record can be played");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
  bool there_ = false;
  std::optional<RangeImage> range_;  ///< whose signal image has not come yet
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<Sonar3d15Fuzzer>(flags);
}
