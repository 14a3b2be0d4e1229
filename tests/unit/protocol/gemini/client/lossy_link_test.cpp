// SPDX-License-Identifier: Apache-2.0
// Client and head at the two ends of a link that loses, doubles, delays and reorders datagrams, in virtual
// time. Every requested image must arrive complete and unchanged.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <queue>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "protocol/gemini/client.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/ping_settings.hpp"

namespace sonard::gemini {
namespace {

using namespace std::chrono_literals;

constexpr Ipv4 head_address = 0x7F000002;
constexpr Ipv4 client_address = 0x7F000001;

struct LinkFaults {
  double loss = 0.0;
  double duplicate = 0.0;
  std::chrono::nanoseconds delay = 100us;
  std::chrono::nanoseconds jitter{};  ///< uniform; if it exceeds the distance of datagrams, it reorders them
};

struct Case {
  const char* name;
  LinkFaults faults;
  std::optional<std::chrono::microseconds> interval;  ///< nullopt: single pings
  std::chrono::nanoseconds render_time;
  int lines;
  int pings = 200;
  bool sixteen_bit = false;
  int rle_threshold = 0;
  int compression_log2 = 0;
  std::chrono::nanoseconds render_lead{};
};

void PrintTo(const Case& value, std::ostream* out) {
  *out << value.name;
}

/// Both ends, the link between them and a renderer of random images.
class Bench {
 public:
  Bench(const Case& settings, std::uint64_t seed)
      : settings_(settings), random_(seed), device_(device_config(settings), 0s), client_(ClientConfig{}) {
    PingSettings wanted;
    wanted.sixteen_bit = settings.sixteen_bit;
    wanted.rle_threshold = settings.rle_threshold;
    wanted.compression_log2 = settings.compression_log2;
    wanted.interval = settings.interval;
    PingConfig config = make_ping_config(wanted);
    config.end_range = static_cast<std::uint16_t>(settings.lines << settings.compression_log2);
    client_.start(0s, config, static_cast<std::uint64_t>(settings.pings));
  }

  /// Runs until the client has finished. Returns false if that takes longer than `limit`.
  bool run(std::chrono::nanoseconds limit) {
    tell_head(TimePassed{});
    client_.advance(now_);
    carry();
    while (!client_.finished() && now_ < limit) {
      step();
    }
    return client_.finished();
  }

  const Client& client() const { return client_; }
  const Device& device() const { return device_; }
  const std::vector<ReceivedPing>& pings() const { return pings_; }
  TimePoint now() const { return now_; }

  /// The image that the head received for the ping with this time stamp; nullptr if there is none.
  const PingImage* image_sent(const ReceivedPing& ping) const {
    const auto found = images_.find(ping.head.transmit_time_us);
    return found == images_.end() ? nullptr : &found->second;
  }

 private:
  struct Event {
    TimePoint at;
    std::uint64_t order;
    std::function<void()> happen;

    bool operator>(const Event& other) const {
      return std::pair(at, order) > std::pair(other.at, other.order);
    }
  };

  static DeviceConfig device_config(const Case& settings) {
    DeviceConfig config;
    config.alternate_address = head_address;
    config.netmask = 0xFF000000;
    config.render_lead = settings.render_lead;
    return config;
  }

  void at(TimePoint when, std::function<void()> happen) {
    events_.push({when, next_order_++, std::move(happen)});
  }

  void step() {
    std::optional<TimePoint> next;
    const auto consider = [&next](std::optional<TimePoint> due) {
      if (due && (!next || *due < *next)) {
        next = due;
      }
    };
    consider(head_wake_at_);
    consider(client_.next_deadline());
    if (!events_.empty()) {
      consider(events_.top().at);
    }
    now_ = std::max(now_, next.value());
    while (!events_.empty() && events_.top().at <= now_) {
      const auto happen = events_.top().happen;
      events_.pop();
      happen();
    }
    if (head_wake_at_ && *head_wake_at_ <= now_) {
      tell_head(TimePassed{});
    }
    client_.advance(now_);
    carry();
  }

  void tell_head(const sonard::Event& event) {
    const Actions actions = device_.step(now_, event);
    for (const Outgoing& datagram : actions.send) {
      transport([this, bytes = datagram.bytes] { client_.on_datagram(now_, bytes); });
    }
    if (actions.render) {
      render(*actions.render);
    }
    head_wake_at_ = actions.wake_at;
  }

  void carry() {
    for (auto& datagram : client_.take_outgoing()) {
      transport([this, bytes = SharedBytes(std::move(datagram.bytes))] {
        tell_head(BytesReceived{{0, {client_address, 52900}, head_address}, bytes});
      });
    }
    for (auto& ping : client_.take_pings()) {
      pings_.push_back(std::move(ping));
    }
  }

  void transport(const std::function<void()>& arrive) {
    const LinkFaults& faults = settings_.faults;
    const int copies = chance(faults.duplicate) ? 2 : 1;
    for (int copy = 0; copy < copies; ++copy) {
      const auto extra = std::chrono::nanoseconds{
          static_cast<std::int64_t>(uniform() * static_cast<double>(faults.jitter.count()))};
      if (!chance(faults.loss)) {
        at(now_ + faults.delay + extra, arrive);
      }
    }
  }

  void render(const PingJob& job) {
    PingImage image;
    image.number = job.number;
    const auto samples = static_cast<std::size_t>(job.bins()) * beam_count;
    if (job.sixteen_bit) {
      image.u16.resize(samples);
      for (auto& sample : image.u16) {
        sample = static_cast<std::uint16_t>(random_());
      }
    } else {
      image.u8.resize(samples);
      for (auto& sample : image.u8) {
        // Half of the samples are small, so that run-length coding drops some.
        const auto value = random_();
        sample = static_cast<std::uint8_t>((value & 0x100) != 0 ? value & 0xFF : value & 0x07);
      }
    }
    images_[static_cast<std::uint64_t>(job.transmit_time / 1us)] = image;
    at(now_ + settings_.render_time, [this, image] { tell_head(PingRendered{image}); });
  }

  double uniform() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  bool chance(double probability) { return uniform() < probability; }

  Case settings_;
  std::mt19937_64 random_;
  Device device_;
  Client client_;
  std::optional<TimePoint> head_wake_at_;
  TimePoint now_ = 0s;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t next_order_ = 0;
  std::map<std::uint64_t, PingImage> images_;
  std::vector<ReceivedPing> pings_;
};

std::vector<std::uint8_t> expected_u8(const PingImage& image, int rle_threshold) {
  auto samples = image.u8;
  for (auto& sample : samples) {
    sample = sample < rle_threshold ? std::uint8_t{0} : sample;  // gemini.md 6.8
  }
  return samples;
}

class LossyLink : public testing::TestWithParam<std::tuple<Case, int>> {};

TEST_P(LossyLink, EveryImageArrivesWholeAndUnchanged) {
  const auto& [settings, seed] = GetParam();
  Bench bench(settings, static_cast<std::uint64_t>(seed));
  ASSERT_TRUE(bench.run(std::chrono::minutes{10})) << bench.pings().size() << " pings came";
  ASSERT_EQ(bench.pings().size(), static_cast<std::size_t>(settings.pings));
  for (const auto& ping : bench.pings()) {
    ASSERT_EQ(ping.lines, settings.lines);
    ASSERT_EQ(ping.lines_lost, 0) << "ping " << ping.number;
    const PingImage* sent = bench.image_sent(ping);
    ASSERT_NE(sent, nullptr) << "ping " << ping.number;
    EXPECT_EQ(ping.head.ping_id & 0xFF, static_cast<int>(sent->number & 0xFF));
    ASSERT_TRUE(ping.samples.u8 == expected_u8(*sent, settings.rle_threshold)) << "ping " << ping.number;
    ASSERT_TRUE(ping.samples.u16 == sent->u16) << "ping " << ping.number;
  }
  const auto& statistics = bench.client().statistics();
  EXPECT_EQ(statistics.pings_complete, static_cast<std::uint64_t>(settings.pings));
  EXPECT_EQ(statistics.pings_incomplete, 0U);
  EXPECT_EQ(statistics.pings_missed, 0U);
  EXPECT_EQ(statistics.lines_missing, 0U);
  if (settings.faults.loss == 0.0 && settings.faults.duplicate == 0.0 && settings.faults.jitter == 0ns) {
    EXPECT_EQ(statistics.retries.total(), 0U) << "asked for something on a link that loses nothing";
    EXPECT_EQ(statistics.lines_duplicate, 0U);
  }
  RecordProperty("seconds_per_ping", std::to_string(std::chrono::duration<double>(bench.now()).count() /
                                                    static_cast<double>(settings.pings)));
}

constexpr LinkFaults clean{};
constexpr LinkFaults lossy{.loss = 0.05};
constexpr LinkFaults rough{.loss = 0.05, .duplicate = 0.05, .jitter = 400us};
constexpr LinkFaults distant{.loss = 0.05, .duplicate = 0.01, .delay = 2ms, .jitter = 500us};
constexpr LinkFaults very_lossy{.loss = 0.25};
constexpr LinkFaults bad{.loss = 0.3, .duplicate = 0.1, .jitter = 400us};

std::string case_name(const testing::TestParamInfo<std::tuple<Case, int>>& info) {
  return std::string(std::get<0>(info.param).name) + "_seed" + std::to_string(std::get<1>(info.param));
}

INSTANTIATE_TEST_SUITE_P(
    Single, LossyLink,
    testing::Combine(testing::Values(Case{"clean", clean, std::nullopt, 30ms, 1205, 40},
                                     Case{"lossy", lossy, std::nullopt, 30ms, 1205},
                                     Case{"short", lossy, std::nullopt, 1ms, 60},
                                     Case{"rough", rough, std::nullopt, 30ms, 603},
                                     Case{"distant", distant, std::nullopt, 30ms, 603},
                                     Case{"very_lossy", very_lossy, std::nullopt, 30ms, 603},
                                     Case{"bad", bad, std::nullopt, 30ms, 603, 60},
                                     Case{"slow_renderer", lossy, std::nullopt, 350ms, 300},
                                     Case{"rendered_ahead", lossy, std::nullopt, 20ms, 1205, 200, false, 0, 0,
                                          20ms},
                                     Case{"sixteen_bit", rough, std::nullopt, 30ms, 300, 200, true},
                                     Case{"run_length", rough, std::nullopt, 30ms, 300, 200, false, 50},
                                     Case{"compressed", rough, std::nullopt, 30ms, 300, 50, false, 0, 4}),
                     testing::Values(1, 2)),
    case_name);

INSTANTIATE_TEST_SUITE_P(
    Continuous, LossyLink,
    testing::Combine(testing::Values(Case{"clean", clean, 100ms, 30ms, 1205, 40},
                                     Case{"clean_fastest", clean, 1ms, 5ms, 1205, 40},
                                     Case{"lossy", lossy, 100ms, 30ms, 1205},
                                     Case{"fastest", lossy, 1ms, 10ms, 1205},
                                     Case{"fastest_instant", lossy, 1ms, 0ms, 1205},
                                     Case{"short_instant", lossy, 1ms, 0ms, 60},
                                     Case{"rough", rough, 1ms, 5ms, 603},
                                     Case{"distant", distant, 1ms, 5ms, 603},
                                     Case{"slow_renderer", lossy, 100ms, 350ms, 300},
                                     Case{"rendered_ahead", lossy, 1ms, 30ms, 1205, 200, false, 0, 0, 30ms},
                                     Case{"sixteen_bit", rough, 50ms, 5ms, 300, 200, true},
                                     Case{"run_length", rough, 50ms, 5ms, 300, 200, false, 50},
                                     Case{"compressed", lossy, 50ms, 5ms, 300, 50, false, 0, 4}),
                     testing::Values(1, 2)),
    case_name);

}  // namespace
}  // namespace sonard::gemini
