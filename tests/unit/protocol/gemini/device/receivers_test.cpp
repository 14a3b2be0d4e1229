// SPDX-License-Identifier: Apache-2.0
// The head against models of both generations of receiver libraries (protocol/gemini/README.md 7.1, 7.2),
// over a link that loses datagrams both ways. Every ping whose head arrives must be complete and intact at
// its end.
#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

/// A ping that a receiver has finished.
struct Completed {
  std::uint64_t transmit_time_us = 0;
  int lost_lines = 0;
  std::vector<std::uint8_t> samples;
};

class Receiver {
 public:
  virtual ~Receiver() = default;
  virtual void on_datagram(TimePoint now, std::span<const std::uint8_t> bytes) = 0;
  virtual std::optional<TimePoint> next_tick() const { return std::nullopt; }
  virtual void on_tick(TimePoint) {}

  std::vector<RetryRequest> requests;  ///< not yet sent
  std::vector<Completed> completed;
  std::optional<TimePoint> last_news;  ///< arrival of the newest head or end of a ping

 protected:
  static constexpr int initial_budget = 6;
  static constexpr int received = -1;

  void ask(RetryKind kind, int line = 0, int count = 1) { requests.push_back(retry_of(kind, line, count)); }

  void begin(TimePoint now, const PingHead& head) {
    open = true;
    last_line = -1;
    current = Completed{head.transmit_time_us, 0, {}};
    budget.assign(static_cast<std::size_t>(head.line_count()), initial_budget);
    current.samples.assign(budget.size() * beam_count, 0);
    last_news = now;
  }
  void take(const PingLine& line) {
    budget[static_cast<std::size_t>(line.line_number())] = received;
    ASSERT_EQ(line.data.size(), 256U);
    std::copy(line.data.begin(), line.data.end(), current.samples.begin() + line.line_number() * 256);
  }
  bool outstanding() const {
    return std::any_of(budget.begin(), budget.end(), [](int left) { return left > 0; });
  }
  void finish(TimePoint now) {
    open = false;
    current.lost_lines = static_cast<int>(std::count(budget.begin(), budget.end(), 0));
    completed.push_back(current);
    last_news = now;
  }

  bool open = false;
  int last_line = -1;
  std::vector<int> budget;
  Completed current;
};

/// Library 1.05: no ping IDs, one request per line, a timer for the tail.
class EarlyReceiver : public Receiver {
 public:
  void on_datagram(TimePoint now, std::span<const std::uint8_t> bytes) override {
    const auto report = decode_report(bytes).value();
    if (const auto* head = std::get_if<PingHead>(&report)) {
      begin(now, *head);
      armed_ = false;
    } else if (const auto* line = std::get_if<PingLine>(&report)) {
      on_line(*line);
    } else if (const auto* tail = std::get_if<PingTail>(&report)) {
      on_tail(now, *tail);
    }
  }
  std::optional<TimePoint> next_tick() const override { return tick_; }
  void on_tick(TimePoint now) override {
    tick_ = now + 5ms;
    if (!open || static_cast<int>(budget.size()) - last_line >= 25) {
      return;
    }
    if (armed_) {
      ask(RetryKind::tail);
      ++timer_requests;
    }
    armed_ = true;
  }

  int timer_requests = 0;

 private:
  void on_line(const PingLine& line) {
    const int number = line.line_number();
    if (!open || number >= static_cast<int>(budget.size())) {
      return;
    }
    if (!line.resent()) {
      for (int skipped = last_line + 1; skipped < number; ++skipped) {
        request_line(skipped);
      }
      last_line = number;
    }
    take(line);
  }
  void on_tail(TimePoint now, const PingTail& tail) {
    if (!open) {
      return;
    }
    if (!outstanding()) {
      finish(now);
    } else if (!tail.resent()) {
      ask(RetryKind::tail);
    } else {
      for (int line = 0; line < static_cast<int>(budget.size()); ++line) {
        request_line(line);
      }
      ask(RetryKind::tail);
    }
  }
  void request_line(int line) {
    int& left = budget[static_cast<std::size_t>(line)];
    if (left > 0) {
      ask(RetryKind::lines, line);
      --left;
    }
  }

  TimePoint tick_{5ms};
  bool armed_ = false;
};

/// Library 2.0.19: ping IDs must match, one request for neighbouring lines, no timer after a burst.
class LaterReceiver : public Receiver {
 public:
  void on_datagram(TimePoint now, std::span<const std::uint8_t> bytes) override {
    const auto report = decode_report(bytes).value();
    if (const auto* head = std::get_if<PingHead>(&report)) {
      if ((head->ping_id & 0xFF00) == 0) {
        begin(now, *head);
        ping_id_ = static_cast<std::uint8_t>(head->ping_id);
      }
    } else if (const auto* line = std::get_if<PingLine>(&report)) {
      on_line(*line);
    } else if (const auto* tail = std::get_if<PingTail>(&report)) {
      on_tail(now, *tail);
    }
  }

 private:
  void on_line(const PingLine& line) {
    const int number = line.line_number();
    if (!open || line.ping_id != ping_id_ || number >= static_cast<int>(budget.size())) {
      return;
    }
    if (!line.resent()) {
      request_gaps(last_line + 1, number);
      last_line = number;
    }
    take(line);
  }
  void on_tail(TimePoint now, const PingTail& tail) {
    if (!open || tail.ping_id != ping_id_) {
      return;
    }
    if (!outstanding()) {
      finish(now);
      return;
    }
    if (tail.resent()) {
      request_gaps(0, static_cast<int>(budget.size()));
    }
    ask(RetryKind::tail);
  }
  void request_gaps(int begin_line, int end_line) {
    for (int line = begin_line; line < end_line;) {
      int end = line;
      while (end < end_line && budget[static_cast<std::size_t>(end)] > 0) {
        --budget[static_cast<std::size_t>(end)];
        ++end;
      }
      if (end > line) {
        ask(RetryKind::lines, line, end - line);
      }
      line = std::max(end, line + 1);
    }
  }

  std::uint8_t ping_id_ = 0;
};

/// Head and receiver, with a lossy link of 150 us each way between them.
class LossyBench {
 public:
  LossyBench(std::unique_ptr<Receiver> receiver, const DeviceConfig& device, double loss, unsigned seed)
      : bench(device), receiver_(std::move(receiver)), loss_(loss), random_(seed) {
    bench.on_sent = [this](const Bench::Sent& sent) {
      if (sent.to == Outgoing::To::peer && !lost(sent.bytes)) {
        to_client_.emplace(sent.at + latency, sent.bytes);
      }
    };
  }

  Bench bench;
  /// Types of datagrams that are never lost, because the real library cannot repair their loss either.
  std::set<std::uint8_t> sure;
  std::uint64_t lost_datagrams = 0;

  Receiver& receiver() { return *receiver_; }

  /// The application. It is called after each event and may send commands through send().
  std::function<void(TimePoint)> application = [](TimePoint) {};
  void send(const Command& command) {
    const auto bytes = encode(command);
    if (!lost(bytes)) {
      to_head_.emplace(bench.now + latency, bytes);
    }
  }

  void run_until(TimePoint end) {
    while (const auto next = next_event(end)) {
      bench.run_until(*next);
      deliver(to_head_, [this](const auto& bytes) { bench.raw(bytes); });
      deliver(to_client_, [this](const auto& bytes) { receiver_->on_datagram(bench.now, bytes); });
      if (receiver_->next_tick() && *receiver_->next_tick() <= bench.now) {
        receiver_->on_tick(bench.now);
      }
      for (const RetryRequest& request : std::exchange(receiver_->requests, {})) {
        send(request);
      }
      application(bench.now);
    }
  }

 private:
  static constexpr std::chrono::nanoseconds latency = 150us;

  template <class Queue, class Action>
  void deliver(Queue& queue, const Action& action) {
    while (!queue.empty() && queue.begin()->first <= bench.now) {
      const auto bytes = queue.begin()->second;
      queue.erase(queue.begin());
      action(bytes);
    }
  }
  std::optional<TimePoint> next_event(TimePoint end) const {
    TimePoint next =
        std::min(bench.next_event(), bench.now + 1ms);  // the application runs once per millisecond
    next = to_client_.empty() ? next : std::min(next, to_client_.begin()->first);
    next = to_head_.empty() ? next : std::min(next, to_head_.begin()->first);
    next = std::min(next, receiver_->next_tick().value_or(next));
    return next <= end ? std::optional(std::max(next, bench.now)) : std::nullopt;
  }
  bool lost(std::span<const std::uint8_t> bytes) {
    const bool is_lost = (random_() >> 8) * 0x1p-24 < loss_ && !sure.contains(bytes[0]);
    lost_datagrams += is_lost ? 1U : 0U;
    return is_lost;
  }

  std::unique_ptr<Receiver> receiver_;
  double loss_;
  std::mt19937 random_;
  std::multimap<TimePoint, SharedBytes> to_client_;
  std::multimap<TimePoint, std::vector<std::uint8_t>> to_head_;
};

/// Checks each completed ping against the rendered image, and that at least `least` pings are complete.
void expect_intact(LossyBench& link, std::size_t least) {
  const auto& completed = link.receiver().completed;
  EXPECT_GE(completed.size(), least);
  EXPECT_GT(link.lost_datagrams, 0U);
  for (const Completed& ping : completed) {
    EXPECT_EQ(ping.lost_lines, 0);
    const auto job = std::ranges::find_if(link.bench.jobs, [&](const PingJob& candidate) {
      return candidate.transmit_time / 1us == static_cast<std::int64_t>(ping.transmit_time_us);
    });
    ASSERT_NE(job, link.bench.jobs.end());
    ASSERT_EQ(ping.samples, test_image(*job).u8);
  }
}

constexpr std::uint8_t head_type = 0x41;
constexpr std::uint8_t tail_type = 0x43;

PingConfig twenty_metres(RunMode mode, std::chrono::microseconds interval = 0us) {
  PingConfig config = ping_of(2411, mode, interval);
  config.range_compression = 1;
  return config;
}

/// Requests the next ping when the last one is complete, and again after a time without datagrams.
std::function<void(TimePoint)> ask_for_one_after_the_other(LossyBench& link, std::size_t& asked) {
  auto asked_at = std::make_shared<TimePoint>(-1s);
  return [&link, &asked, asked_at](TimePoint now) {
    const bool answered = asked == link.receiver().completed.size();
    if (answered || now - std::max(*asked_at, link.receiver().last_news.value_or(-1s)) > 300ms) {
      asked = link.receiver().completed.size() + 1;
      *asked_at = now;
      link.send(twenty_metres(RunMode::single));
    }
  };
}

class Receivers : public testing::TestWithParam<unsigned> {};

TEST_P(Receivers, EarlyLibraryGetsEverySinglePing) {
  LossyBench link(std::make_unique<EarlyReceiver>(), example_config(), 0.05, GetParam());
  link.bench.render_time = 20ms;
  std::size_t asked = 0;
  link.application = ask_for_one_after_the_other(link, asked);
  link.run_until(3s);
  expect_intact(link, 20);
  EXPECT_GT(link.bench.device.counters().lines_resent, 500U);
}

TEST_P(Receivers, EarlyLibraryGetsEveryContinuousPingWhoseHeadArrives) {
  LossyBench link(std::make_unique<EarlyReceiver>(), example_config(), 0.05, GetParam());
  link.sure = {head_type};
  link.bench.render_time = 20ms;
  bool running = false;
  link.application = [&](TimePoint now) {
    if (!running || (now % 1s) < 1ms) {  // stay-alive
      link.send(running ? Command{to_head<StatusRequest>()}
                        : Command{twenty_metres(RunMode::continuous, 100ms)});
      running = link.bench.device.counters().pings_started > 0;
    }
  };
  link.run_until(3s);
  expect_intact(link, link.bench.count(MessageType::ping_head) - 1);  // the last one may be under way
  EXPECT_GT(link.bench.count(MessageType::ping_head), 27U);
}

TEST_P(Receivers, EarlyLibraryAsFastAsPossibleIsRepairedBeforeTheNextHead) {
  LossyBench link(std::make_unique<EarlyReceiver>(), example_config(), 0.02, GetParam());
  link.sure = {head_type, tail_type, 0x30};  // at this rate a tail lost at the end cannot be repaired
  link.bench.render_time = 5ms;
  bool running = false;
  link.application = [&](TimePoint now) {
    if (!running || (now % 1s) < 1ms) {
      link.send(running ? Command{to_head<StatusRequest>()} : Command{twenty_metres(RunMode::continuous)});
      running = link.bench.device.counters().pings_started > 0;
    }
  };
  link.run_until(3s);
  expect_intact(link, link.bench.count(MessageType::ping_head) - 1);
  EXPECT_GT(link.bench.count(MessageType::ping_head), 45U) << "repair slows it down, but not much";
}

TEST_P(Receivers, LaterLibraryGetsEverySinglePing) {
  LossyBench link(std::make_unique<LaterReceiver>(), example_config(), 0.05, GetParam());
  link.bench.render_time = 20ms;
  std::size_t asked = 0;
  link.application =
      ask_for_one_after_the_other(link, asked);  // also after a lost tail, like the library's application
  link.run_until(3s);
  expect_intact(link, 9);
}

TEST_P(Receivers, LaterLibraryGetsEveryContinuousPingWhoseHeadAndTailArrive) {
  LossyBench link(std::make_unique<LaterReceiver>(), example_config(), 0.05, GetParam());
  link.sure = {head_type, tail_type, 0x30};
  link.bench.render_time = 20ms;
  bool running = false;
  link.application = [&](TimePoint now) {
    if (!running || (now % 1s) < 1ms) {
      link.send(running ? Command{to_head<StatusRequest>()}
                        : Command{twenty_metres(RunMode::continuous, 80ms)});
      running = link.bench.device.counters().pings_started > 0;
    }
  };
  link.run_until(3s);
  expect_intact(link, link.bench.count(MessageType::ping_head) - 1);
}

TEST_P(Receivers, LosingAThirdOfTheLinesIsRepairedToo) {
  LossyBench link(std::make_unique<EarlyReceiver>(), example_config(), 0.33, GetParam());
  link.sure = {head_type, tail_type, 0x21, 0x30};
  link.bench.render_time = 20ms;
  std::size_t asked = 0;
  link.application = ask_for_one_after_the_other(link, asked);
  link.run_until(2s);
  EXPECT_GE(link.receiver().completed.size(), 10U);
  for (const Completed& ping : link.receiver().completed) {
    EXPECT_LE(ping.lost_lines, 5);  // 1205 lines, each lost seven times in a row with 0.33^7 = 0.0004
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Receivers, testing::Values(1U, 2U, 3U));

TEST(Receivers, CleanLinkDrawsNoRequestAtAll) {
  for (const int k : {0, 1, 4}) {
    LossyBench link(std::make_unique<EarlyReceiver>(), example_config(), 0.0, 1);
    link.bench.render_time = 20ms;
    link.bench.lateness = [] { return 300us; };
    PingConfig config = ping_of(6000, RunMode::continuous, 200ms);
    config.range_compression = static_cast<std::uint16_t>(k);
    link.send(config);
    link.run_until(2900ms);
    EXPECT_GE(link.receiver().completed.size(), 14U);
    EXPECT_EQ(link.bench.device.counters().retries_received, 0U)
        << "the timer of the library must stay quiet";
  }
}

std::string line_word(int number) {
  return std::string("line ").append(std::to_string(number));
}

// The document's example: line 10 of 483 lost once.
TEST(Receivers, OneLostLineRunsAsDocumented) {
  Bench bench;
  EarlyReceiver receiver;
  std::vector<std::string> head_says;
  std::vector<std::string> client_says;
  bool dropped = false;
  bench.on_sent = [&](const Bench::Sent& sent) {
    const auto report = decode_report(sent.bytes).value();
    if (const auto* line = std::get_if<PingLine>(&report)) {
      if (line->line_id == 10 && !std::exchange(dropped, true)) {
        return;
      }
      if (line->resent()) {
        head_says.push_back(line_word(line->line_number()));
      }
    } else if (const auto* tail = std::get_if<PingTail>(&report)) {
      head_says.emplace_back(tail->resent() ? "tail again" : "tail");
    }
    receiver.on_datagram(sent.at, sent.bytes);
  };
  bench.command(ping_of(483));
  while (bench.now < 100ms) {
    bench.run_for(100us);
    for (const RetryRequest& request : std::exchange(receiver.requests, {})) {
      client_says.push_back(request.kind == RetryKind::lines ? line_word(request.first_line) : "tail");
      bench.command(request);
    }
  }
  EXPECT_EQ(client_says, (std::vector<std::string>{"line 10", "tail"}));
  EXPECT_EQ(head_says, (std::vector<std::string>{"tail", "line 10", "tail again"}));
  ASSERT_EQ(receiver.completed.size(), 1U);
  EXPECT_EQ(receiver.completed[0].lost_lines, 0);
}

}  // namespace
}  // namespace sonard::gemini
