// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of three clients, images, faults and pauses against a Ping360.
// Promises: every frame sent is a whole message of a head, for one peer; the next deadline lies in the
// future; every job can be rendered; time goes on with any input.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <variant>

#include "protocol/ping360/codec.hpp"
#include "protocol/ping360/device.hpp"
#include "protocol/ping360/recorded_form.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::ping360;
using sonard::Actions;
using sonard::Outgoing;
using sonard::Peer;
using sonard::PingImage;
using sonard::PingJob;
using sonard::SharedBytes;
using sonard::TimePoint;
using sonard::fuzz::Event;
using sonard::fuzz::require;
using sonard::fuzz::Script;

/// Kinds of events. The first three carry bytes, each from its own client: number and payload of a message,
/// or a raw piece of stream.
enum Kind { byte_kinds = 3, client_gone = 3, image = 4, image_failed = 5, feed = 6, next_due = 7 };

constexpr int serial_channel = 2;

Peer peer_of(int kind) {
  const auto number = static_cast<std::uint16_t>(kind);
  return kind == serial_channel ? Peer{serial_channel, {}, 0} : Peer{0, {0x7F000001, number}, 0};
}

/// The configuration that the first byte of an input selects.
DeviceConfig config_of(unsigned flags) {
  DeviceConfig config;
  config.serial_channel = serial_channel;
  config.plays_back = (flags & 0x01U) != 0;
  config.simulated_time = (flags & 0x02U) != 0;
  config.fan_out = (flags & 0x04U) != 0 ? FanOut::all : FanOut::requester;
  config.time_scale = (flags & 0x08U) != 0 ? 0.0 : 1.0;
  config.max_datagram = (flags & 0x10U) != 0 ? 100 : 0;
  config.signed_scan_angles = (flags & 0x20U) != 0;
  config.clamps_scan_to_stop = (flags & 0x40U) != 0;
  config.max_clients = (flags & 0x80U) != 0 ? 2 : 32;
  return config;
}

class Bench {
 public:
  explicit Bench(unsigned flags) : config_(config_of(flags)) { step(sonard::TimePassed{}); }

  void play(const Event& event) {
    run_until(now_ + event.delay);
    switch (event.kind) {
      case client_gone:
        step(sonard::ClientGone{peer_of(0)});
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
        if (last_.next_ping && last_.next_ping->from <= now_) {
          step(sonard::NextPingDue{});
        }
        break;
      default:
        hear(event);
    }
  }

 private:
  static sonard::ReplayedPing recorded() {
    sonard::ReplayedPing ping;
    ping.settings = {.bins = 20, .beams = 1, .bin_m = 0.01, .sound_speed_mps = 1500.0};
    ping.wire = recorded_wire(form_of(Transducer{.angle = 50, .number_of_samples = 20}), 2);
    return ping;
  }

  void hear(const Event& event) {
    const std::span<const std::uint8_t> bytes = event.datagram;
    const bool as_is = event.as_is || bytes.size() < 2;
    step(sonard::BytesReceived{
        peer_of(event.kind),
        SharedBytes(as_is ? event.datagram
                          : make_frame(static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8), client_id, 0,
                                       bytes.subspan(2)))});
  }

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups && last_.wake_at && *last_.wake_at <= target; ++i) {
      now_ = std::max(now_, *last_.wake_at);
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void check_message(const Outgoing& outgoing) const {
    require(outgoing.to == Outgoing::To::peer, "messages are for one peer each");
    if (config_.max_datagram > 0) {
      require(outgoing.bytes.size() <= config_.max_datagram, "datagrams are as short as they are to be");
      return;
    }
    const std::span<const std::uint8_t> frame{outgoing.bytes};
    require(next_frame(frame) == static_cast<std::ptrdiff_t>(frame.size()), "one whole frame at a time");
    const auto report = decode_report(frame);
    require(report.has_value() && !std::holds_alternative<Unknown>(*report),
            "a head speaks its own protocol");
  }

  void check_job(const PingJob& job) const {
    require(!job_.has_value(), "one job at a time");
    require(job.bins() >= 1 && job.bins() <= 1200, "a job can be rendered");
    constexpr double half_a_turn = std::numbers::pi + 1e-9;  // with rounding
    require(std::abs(job.bearing_rad) <= half_a_turn, "a job has a bearing of one turn");
    require(job.transmit_time <= now_, "a job is not ahead of its time");
    require(!config_.plays_back || job.record.has_value(), "a player renders nothing");
  }

  void step(const sonard::Event& event) {
    last_ = device_.step(now_, event);
    for (const Outgoing& outgoing : last_.send) {
      check_message(outgoing);
    }
    if (last_.render) {
      check_job(*last_.render);
      job_ = last_.render;
    }
    if (last_.record) {
      require(last_.record->samples.size() == static_cast<std::size_t>(last_.record->settings.bins),
              "a record holds a whole ping");
      require(recorded_form(last_.record->wire).has_value(), "a record can be played");
    }
    require(!last_.cancelled || (job_ && job_->number == *last_.cancelled), "what is cancelled is out");
    const auto& counters = device_.counters();
    require(counters.pings_sent + counters.pings_failed + counters.pings_cancelled <= counters.pings_started,
            "every answer has its ping");
    require(!last_.wake_at || *last_.wake_at > now_, "the next deadline is later than now");
  }

  void answer_job(bool rendered) {
    const auto job = std::exchange(job_, std::nullopt);
    if (!job) {
      return;
    }
    if (rendered) {
      step(sonard::PingRendered{
          PingImage{job->number, std::vector<std::uint8_t>(static_cast<std::size_t>(job->bins()), 77), {}}});
    } else {
      step(sonard::PingNotRendered{job->number});
    }
  }

  TimePoint now_{};
  DeviceConfig config_;
  Device device_{config_, now_};
  Actions last_;
  std::optional<PingJob> job_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  Bench bench(data[0]);
  for (Script script{{data + 1, size - 1}, byte_kinds}; !script.done();) {
    bench.play(script.next());
  }
  return 0;
}
