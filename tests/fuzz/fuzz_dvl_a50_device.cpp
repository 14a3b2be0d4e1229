// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of clients on all channels, images, faults and pauses against a DVL.
// Promises, beside those of all heads: every message of the JSON channel is one object and a line end.
#include <memory>
#include <string>
#include <vector>

#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/json.hpp"
#include "protocol/dvl_a50/recorded_form.hpp"
#include "tests/fuzz/device_fuzzer.hpp"

namespace {

using namespace sonard::dvl_a50;
using sonard::Outgoing;
using sonard::Peer;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::fuzz::Event;
using sonard::fuzz::require;

/// Kinds of events. The first three carry bytes: of a JSON client, of the serial line, of an HTTP client.
enum Kind { json, serial, http, client_gone, image, image_failed, feed, next_due };

constexpr int serial_channel = 1, http_channel = 2;

Peer peer_of(int kind) {
  return kind == serial ? Peer{serial_channel, {}, 0}
                        : Peer{kind == http ? http_channel : json_channel, {1, 2}, 0};
}

/// The configuration that the first byte of an input selects.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.serial_channel = (flags & 0x04U) != 0 ? serial_channel : -1;
  config.http_channel = http_channel;
  config.time_scale = (flags & 0x08U) != 0 ? 0.0 : 1.0;
  config.settings.acoustic_enabled = (flags & 0x10U) == 0;
  config.release = (flags & 0x20U) != 0 ? Release::v2_2_1 : Release::v2_7_2;
  config.ntp_synced = (flags & 0x40U) != 0;
  config.processing_delay = std::chrono::milliseconds((flags & 0x80U) != 0 ? 0 : 150);
  return config;
}

class DvlFuzzer final : public sonard::fuzz::DeviceFuzzer {
 public:
  explicit DvlFuzzer(unsigned flags) : config_(config_of(flags)) {}

  int byte_kinds() const override { return client_gone; }

 private:
  sonard::Device& device() override { return device_; }
  const sonard::PingCounters& counters() const override { return device_.counters(); }
  bool plays_back() const override { return config_.plays_back; }
  int most_bins() const override { return 20'000; }

  void happen(const Event& event) override {
    switch (event.kind) {
      case client_gone:
        step(sonard::ClientGone{peer_of(json)});
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
        step(sonard::BytesReceived{peer_of(event.kind), SharedBytes(event.datagram)});
    }
  }

  static sonard::ReplayedPing recorded() {
    sonard::ReplayedPing ping;
    ping.settings = {.bins = 200, .beams = 1, .bin_m = 0.1, .sound_speed_mps = 1475.0};
    ping.wire = record_of({}, 20.0, 1475.0).wire;
    return ping;
  }

  void check_message(const Outgoing& outgoing) override {
    require(outgoing.to == Outgoing::To::peer, "messages are for one peer each");
    const std::string text(outgoing.bytes.begin(), outgoing.bytes.end());
    require(text.size() < 200'000, "a message has an end");
    if (outgoing.peer.channel == json_channel) {
      require(text.ends_with("}\r\n") && parse_json(text.substr(0, text.size() - 2)),
              "a message is an object");
    }
  }

  void check_job(const PingJob& job) const override {
    require(job.record || job.directions.any(), "a job asks for directions");
    require(job.transmit_time <= now(), "a job is not ahead of its time");
  }

  void check_record(const sonard::PingRecord& record) const override {
    require(recorded_form(record.wire).has_value(), "a record can be played");
  }

  DeviceConfig config_;
  Device device_{config_, {}};
};

}  // namespace

std::unique_ptr<sonard::fuzz::DeviceFuzzer> sonard::fuzz::make_device_fuzzer(unsigned flags) {
  return std::make_unique<DvlFuzzer>(flags);
}
