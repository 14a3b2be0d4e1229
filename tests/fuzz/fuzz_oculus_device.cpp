// SPDX-License-Identifier: Apache-2.0
// Any sequence of bytes of two clients, images, faults and pauses against an Oculus, and its messages against
// the code of a client. Promises: every message sent is whole and of the head's own protocol; of two clients
// one is disconnected, the first only after a silence; the next deadline lies in the future; every job can be
// rendered, and every record played; time goes on with any input.
#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/device.hpp"
#include "protocol/oculus/recorded_form.hpp"
#include "tests/fuzz/require.hpp"
#include "tests/fuzz/script.hpp"

namespace {

using namespace sonard::oculus;
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
  config.plan.model = (flags & 0x04U) != 0 ? m1200d : m750d;
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

class Bench {
 public:
  explicit Bench(unsigned flags) : config_(config_of(flags)) { step(sonard::TimePassed{}); }

  void play(const Event& event) {
    run_until(now_ + event.delay);
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
          require(last_.disconnect.size() == 1, "of two clients one is sent away");
          step(sonard::ClientGone{last_.disconnect.front()});
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
        if (last_.next_ping && last_.next_ping->from <= now_) {
          step(sonard::NextPingDue{});
        }
        break;
      default:
        receive(event);
    }
  }

 private:
  void takes_place(const Peer& client) {
    client_peer_ = client;
    came_ = now_;
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

  void run_until(TimePoint target) {
    constexpr int most_wake_ups = 1000;
    for (int i = 0; i < most_wake_ups && last_.wake_at && *last_.wake_at <= target; ++i) {
      now_ = std::max(now_, *last_.wake_at);
      step(sonard::TimePassed{});
    }
    now_ = target;
    step(sonard::TimePassed{});
  }

  void check_message(const Outgoing& outgoing) {
    if (outgoing.to == Outgoing::To::everybody) {
      require(decode_status(outgoing.bytes).has_value(), "a status is whole");
      return;
    }
    require(client_peer_ == outgoing.peer, "messages are for the client");
    const ClientStatistics before = client_.statistics();
    client_.receive(now_, outgoing.bytes);
    const ClientStatistics& after = client_.statistics();
    require(after.messages == before.messages + 1, "one whole message at a time");
    require(after.bad_messages == 0 && after.dropped_bytes == 0, "a head speaks its own protocol");
    require(after.pings_missed == 0, "numbers of pings count up");
  }

  void check_job(const PingJob& job) const {
    require(!job_.has_value(), "one job at a time");
    require(client_peer_.has_value(), "nobody wants it");
    require(job.bins() >= 1 && job.bins() <= 3, "a job can be rendered");
    require(job.native_bin_m > 0.0 && job.native_bin_m < 1000.0, "its rows have a length");
    require(job.beams == 256 || job.beams == 512, "it has beams");
    require(job.amplitude_exponent > 0.0 && job.amplitude_exponent <= 1.0, "it has a gamma");
    require(job.gain_percent >= 0.0 && job.gain_percent <= 100.0, "it has a gain");
    require(job.transmit_time <= now_, "a job is not ahead of its time");
    require(!config_.plays_back || job.record.has_value(), "a player renders nothing");
  }

  void step(const sonard::Event& event) {
    last_ = device_.step(now_, event);
    const auto* other = std::get_if<sonard::ClientCame>(&event);
    if (other != nullptr && client_peer_ && std::ranges::count(last_.disconnect, *client_peer_) > 0) {
      require(now_ - came_ >= Device::most_silence, "a client that has just come stays");
      takes_place(other->who);
    }
    for (const Outgoing& outgoing : last_.send) {
      check_message(outgoing);
    }
    if (last_.render) {
      check_job(*last_.render);
      job_ = last_.render;
    }
    if (last_.record) {
      const sonard::RecordedSettings& settings = last_.record->settings;
      require(last_.record->samples.size() == static_cast<std::size_t>(settings.bins * settings.beams),
              "a record holds a whole ping");
      require(recorded_form(last_.record->wire).has_value(), "a record can be played");
    }
    require(!last_.cancelled || (job_ && job_->number == *last_.cancelled), "what is cancelled is out");
    require(!last_.wake_at || *last_.wake_at > now_, "the next deadline is later than now");
  }

  void answer_job(bool rendered) {
    const auto job = std::exchange(job_, std::nullopt);
    if (!job) {
      return;
    }
    if (!rendered) {
      step(sonard::PingNotRendered{job->number});
      return;
    }
    PingImage samples;
    samples.number = job->number;
    const auto count = static_cast<std::size_t>(job->bins()) * static_cast<std::size_t>(job->beams);
    if (job->sixteen_bit && !job->record) {
      samples.u16.assign(count, 7777);
    } else {
      samples.u8.assign(count, 77);
    }
    step(sonard::PingRendered{samples});
  }

  TimePoint now_{};
  DeviceConfig config_;
  Device device_{config_, now_};
  Client client_;
  std::optional<Peer> client_peer_;
  TimePoint came_{};  ///< time at which the client came
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
