// SPDX-License-Identifier: Apache-2.0
// Streams of poses with one fault in their stamps, looked at again and again as the daemon does.
#include "server/diagnosis/pose_stream.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::HasSubstr;

/// Maps the nanoseconds since the start to a stamp, as sonard reads it.
using Stamp = std::function<std::int64_t(std::int64_t)>;

struct Stream {
  StampField field{};
  Stamp stamp;
  double speed_mps = 0.5;
  PingClock clock = PingClock::wall;
  milliseconds period{50};
  milliseconds waits{0};  ///< earlier poses arrive only now, one after the other
};

/// The findings of six seconds, looked at after every pose; consecutive equal codes count once.
std::vector<Finding> findings_of(const Stream& stream) {
  constexpr TimePoint begin = std::chrono::hours{5};
  PoseStatistics statistics(milliseconds{500});
  std::vector<Finding> findings;
  for (std::chrono::nanoseconds since{0}; since < std::chrono::seconds{6}; since += stream.period) {
    pose::PoseSample sample;
    sample.time_ns = stream.stamp(since.count());
    sample.T_world_vehicle.position_m.x = stream.speed_mps * 1e-9 * static_cast<double>(since.count());
    const std::chrono::nanoseconds waits = stream.waits;
    const TimePoint arrival = begin + (since < waits ? waits + since / 1'000'000 : since);
    statistics.observe(sample, arrival);
    const auto found =
        look_at_stamps(statistics, stream.field, stream.clock, arrival + std::chrono::microseconds{1});
    if (found && (findings.empty() || findings.back().code != found->code)) {
      findings.push_back(*found);
    }
  }
  return findings;
}

/// Expects one finding in all, which has these words, the name of the field and its unit.
void expect_one(const Stream& stream, const std::string& words) {
  const std::vector<Finding> findings = findings_of(stream);
  ASSERT_EQ(findings.size(), 1U) << words << ": " << (findings.empty() ? "none" : findings.back().text);
  EXPECT_THAT(findings[0].text, AllOf(HasSubstr(words), HasSubstr("Send "), HasSubstr(stream.field.name),
                                      HasSubstr(" in " + stream.field.unit + ".")));
}

constexpr std::int64_t unix_s = 1'732'800'000;

Stamp in_unit(std::int64_t unit_ns) {
  return [unit_ns](std::int64_t since_ns) { return (unix_s * 1'000'000'000 + since_ns) / unit_ns; };
}
std::int64_t left_out(std::int64_t) {
  return 0;
}
std::int64_t alike(std::int64_t) {
  return unix_s * 1'000'000'000 + 123'456'789;
}

TEST(PoseStream, PosesThatWaitedHaveTheUnitOfTheOthers) {
  EXPECT_TRUE(findings_of({.stamp = in_unit(1), .waits = milliseconds{3000}}).empty());
  expect_one({.stamp = in_unit(1'000), .waits = milliseconds{3000}}, "look like microseconds");
  expect_one({.stamp = in_unit(1'000'000), .waits = milliseconds{3000}}, "look like milliseconds");
}

TEST(PoseStream, GoodStampsAreNoFinding) {
  EXPECT_TRUE(findings_of({.stamp = in_unit(1)}).empty());
  EXPECT_TRUE(findings_of({.stamp = in_unit(1), .speed_mps = 0.0}).empty());
  EXPECT_TRUE(findings_of({.field = {"time_boot_ms", "milliseconds", 1e-3},
                           .stamp = [](std::int64_t since_ns) { return since_ns / 1'000'000 * 1'000'000; }})
                  .empty());
}

TEST(PoseStream, StampsThatAreLeftOutOrAlikeAreOneFinding) {
  for (const Stamp& stamp : {Stamp(left_out), Stamp(alike)}) {
    for (const double speed_mps : {0.0, 0.5}) {
      expect_one({.stamp = stamp, .speed_mps = speed_mps}, "is time_ns missing?");
    }
    expect_one({.stamp = stamp, .speed_mps = 0.0, .clock = PingClock::simulated}, "the heads do not ping");
    expect_one({.stamp = stamp, .clock = PingClock::simulated_lock_step},
               "so the heads do not ping (poses.clock)");
  }
}

TEST(PoseStream, StampsInAnotherUnitAreOneFinding) {
  expect_one({.stamp = [](std::int64_t since_ns) { return 1 + since_ns / 1'000'000'000; }},
             "look like seconds");
  for (const milliseconds period : {milliseconds{10}, milliseconds{50}, milliseconds{200}}) {
    expect_one({.stamp = in_unit(1'000), .period = period}, "look like microseconds");
    expect_one({.stamp = in_unit(1'000'000), .period = period}, "look like milliseconds");
    expect_one({.stamp = in_unit(1'000'000'000), .period = period}, "look like seconds");
  }
}

// time_boot_ms counts milliseconds, so a vehicle that sends seconds is slower by 1000, not by 10^9.
TEST(PoseStream, UnitsAreThoseOfTheFieldOfTheInput) {
  const StampField boot{"time_boot_ms", "milliseconds", 1e-3};
  const StampField usec{"time_usec", "microseconds", 1e-6};
  constexpr std::int64_t first = 18'000'400'000'000;  // sonard adds the time of the first arrival
  expect_one({.field = boot,
              .stamp = [](std::int64_t since_ns) { return first + since_ns / 1'000'000'000 * 1'000'000; }},
             "look like seconds. Send time_boot_ms in milliseconds.");
  expect_one(
      {.field = boot, .stamp = [](std::int64_t since_ns) { return first + since_ns / 1'000 * 1'000'000; }},
      "look like microseconds. Send time_boot_ms in milliseconds.");
  expect_one(
      {.field = usec, .stamp = [](std::int64_t since_ns) { return first + since_ns / 1'000'000 * 1'000; }},
      "look like milliseconds. Send time_usec in microseconds.");
}

TEST(PoseStream, StampsThatAreRoundedCountedOrBackwardsAreOneFinding) {
  expect_one(
      {.stamp = [](std::int64_t since_ns) { return (unix_s + since_ns / 1'000'000'000) * 1'000'000'000; }},
      "is time_ns in whole seconds?");
  expect_one({.stamp = [](std::int64_t since_ns) { return since_ns / 50'000'000; }}, "do they count poses?");
  expect_one({.stamp = [](std::int64_t since_ns) { return unix_s * 1'000'000 - since_ns; }},
             "Stamps run backwards by 1 s per second");
}

// By the wall clock heads ping whatever the stamps are.
TEST(PoseStream, StampsThatDoNotAdvanceStopThePingsThatWaitForThem) {
  const std::vector<Stream> stopped{
      {.stamp = left_out, .speed_mps = 0.0},
      {.stamp = alike},
      {.stamp = in_unit(1'000'000)},
      {.stamp = [](std::int64_t since_ns) { return since_ns / 50'000'000; }},
      {.stamp = [](std::int64_t since_ns) { return unix_s * 1'000'000 - since_ns; }},
  };
  for (Stream stream : stopped) {
    for (const PingClock clock : {PingClock::wall, PingClock::simulated, PingClock::simulated_lock_step}) {
      stream.clock = clock;
      const std::vector<Finding> findings = findings_of(stream);
      ASSERT_EQ(findings.size(), 1U);
      EXPECT_EQ(findings[0].stops_pings, clock != PingClock::wall) << findings[0].text;
    }
  }
  const std::vector<Finding> rounded = findings_of(
      {.stamp = [](std::int64_t since_ns) { return (unix_s + since_ns / 1'000'000'000) * 1'000'000'000; },
       .clock = PingClock::simulated});
  ASSERT_EQ(rounded.size(), 1U);
  EXPECT_FALSE(rounded[0].stops_pings) << "a ping comes with each second";
}

/// The finding about the rate after ten poses, one each period, whose stamps advance by `stamp_step`.
std::optional<Finding> rate_finding(milliseconds period, milliseconds stamp_step, PingClock clock,
                                    milliseconds silence = milliseconds{0}) {
  PoseStatistics statistics(milliseconds{500});
  TimePoint arrival = std::chrono::hours{5};
  for (int i = 0; i < 10; ++i) {
    pose::PoseSample sample;
    sample.time_ns = i * std::chrono::nanoseconds{stamp_step}.count();
    statistics.observe(sample, arrival += period);
  }
  return look_at_rate(statistics, clock, arrival + silence);
}

TEST(PoseStream, PosesAtOneHertzAreTooRare) {
  const milliseconds second{1000}, good{50};
  const auto rare = rate_finding(second, second, PingClock::wall);
  ASSERT_TRUE(rare);
  EXPECT_THAT(rare->text,
              AllOf(HasSubstr("Poses arrive at only 1 Hz,"), HasSubstr("Publish at 10 Hz or more")));
  EXPECT_FALSE(rate_finding(good, good, PingClock::wall));
  EXPECT_FALSE(rate_finding(milliseconds{100}, milliseconds{100}, PingClock::wall));
  EXPECT_FALSE(rate_finding(second, second, PingClock::wall, milliseconds{10'000})) << "it has stopped";
}

TEST(PoseStream, ASlowSimulationIsNoRarePublisher) {
  const milliseconds second{1000}, good{50};
  EXPECT_FALSE(rate_finding(second, good, PingClock::simulated));
  EXPECT_FALSE(rate_finding(second, good, PingClock::simulated_lock_step));
  const auto rare = rate_finding(good, second, PingClock::simulated_lock_step);
  ASSERT_TRUE(rare);
  EXPECT_THAT(rare->text, HasSubstr("Poses arrive at only 1 Hz by their stamps"));
}

TEST(PoseStream, AClockThatWentBackIsNamedWithItsField) {
  const std::vector<Finding> findings = findings_of({.stamp = [](std::int64_t since_ns) {
    return since_ns < 3'000'000'000 ? since_ns : since_ns - 3'000'000'000;
  }});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].text, AllOf(HasSubstr("clock went back 1 time"), HasSubstr("time_ns")));
}

}  // namespace
}  // namespace sonard::server
