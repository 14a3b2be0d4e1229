// SPDX-License-Identifier: Apache-2.0
// Poses by Ignition Transport from independent programs: one with the stock library, and its command line
// tool. They run in a network of this test process alone, with multicast on its loopback.
#include "server/pose/gazebo/source.hpp"

#include <gmock/gmock.h>
#include <sched.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdlib>
#include <iostream>

#include "server/pose/pose_history.hpp"
#include "tests/unit/server/pose/child_process.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::seconds;
using test::ChildProcess;

class GazeboPoseSourceTest : public SourceTest {
 protected:
  // Before the library opens its sockets: it opens them once per process and never closes them.
  static void SetUpTestSuite() {
    const int flags = geteuid() == 0 ? CLONE_NEWNET : CLONE_NEWNET | CLONE_NEWUSER;
    ASSERT_EQ(unshare(flags), 0) << "no network namespace to be had";
    ASSERT_EQ(std::system("ip link set lo up multicast on && ip route add 239.0.0.0/8 dev lo"), 0);
  }

  std::unique_ptr<GazeboPoseSource> started(const std::string& topic) {
    GazeboPoseInput input;
    input.topic = topic;
    input.vehicle.name = "rov";
    auto source = std::make_unique<GazeboPoseSource>(io_, input, clock_, sink_);
    source->start();
    return source;
  }
  static ChildProcess publisher(const std::string& topic, const std::string& time_rate,
                                const std::string& type) {
    return ChildProcess{{GAZEBO_PUBLISHER, topic, "20", time_rate, type, "rov", "1", "2", "-3", "0", "0",
                         "90", "crab", "1", "2", "-3", "0", "0", "90"}};
  }
  void expect_the_pose() {
    const pose::Transform& T = delivered_.back().sample.T_world_vehicle;
    EXPECT_EQ(T.position_m.x, 1.0);
    EXPECT_EQ(T.position_m.y, 2.0);
    EXPECT_EQ(T.position_m.z, -3.0);
    const pose::Vec3 ahead = pose::rotate(T.orientation, {1, 0, 0});
    EXPECT_NEAR(ahead.y, 1.0, 1e-12) << "a quarter turn to port from east is north";
  }
};

TEST_F(GazeboPoseSourceTest, TakesPosesOfTheStockLibraryUnderEitherPackageName) {
  for (const char* type : {"ignition.msgs.Pose_V", "gz.msgs.Pose_V"}) {
    delivered_.clear();
    const std::string topic = std::string("/stock/") + type[0];
    const auto source = started(topic);
    const ChildProcess other = publisher(topic, "1", type);
    ASSERT_TRUE(run_until_delivered(20)) << type;
    expect_the_pose();
    EXPECT_GT(delivered_[19].sample.time_ns, delivered_[0].sample.time_ns);
    EXPECT_GE(delivered_[19].arrival, delivered_[0].arrival);
    EXPECT_EQ(source->counters().malformed + source->counters().bad_value, 0U);
  }
}

TEST_F(GazeboPoseSourceTest, AgesPosesOfAFastOrSlowSimulationByItsOwnClock) {
  for (const char* rate : {"0.1", "5"}) {
    delivered_.clear();
    const std::string topic = std::string("/rate/") + rate[0];
    const auto source = started(topic);
    const ChildProcess other = publisher(topic, rate, "ignition.msgs.Pose_V");
    ASSERT_TRUE(run_until_delivered(50));
    PoseHistory history{PoseConfig{}};
    for (const Delivery& delivery : delivered_) {
      history.insert(delivery.sample, delivery.arrival);
      const auto estimate = history.at(delivery.arrival);
      ASSERT_TRUE(estimate);
      EXPECT_NE(estimate->quality, PoseQuality::stale) << rate;
    }
    EXPECT_EQ(history.counters().clock_restarts, 0U);
    EXPECT_EQ(history.at(delivered_.back().arrival + seconds{1})->quality, PoseQuality::stale);
  }
}

TEST_F(GazeboPoseSourceTest, FollowsASimulationThatIsReset) {
  const auto source = started("/reset");
  PoseHistory history{PoseConfig{}};
  {
    const ChildProcess before = publisher("/reset", "5", "ignition.msgs.Pose_V");
    ASSERT_TRUE(
        run_until([&] { return !delivered_.empty() && delivered_.back().sample.time_ns > 2'000'000'000; }));
  }
  const ChildProcess after = publisher("/reset", "1", "ignition.msgs.Pose_V");
  ASSERT_TRUE(run_until([&] { return delivered_.back().sample.time_ns < 1'000'000'000; }));
  for (const Delivery& delivery : delivered_) {
    history.insert(delivery.sample, delivery.arrival);
  }
  EXPECT_EQ(history.counters().clock_restarts, 1U);
  EXPECT_NE(history.at(delivered_.back().arrival)->quality, PoseQuality::stale);
}

TEST_F(GazeboPoseSourceTest, CountsMessagesOfAnotherType) {
  const auto source = started("/other");
  const ChildProcess other = publisher("/other", "1", "ignition.msgs.StringMsg");
  ASSERT_TRUE(run_until([&] { return source->counters().malformed >= 3; }));
  EXPECT_TRUE(delivered_.empty());
}

TEST_F(GazeboPoseSourceTest, DeliversNothingOnceStopped) {
  const auto source = started("/stop");
  const ChildProcess other = publisher("/stop", "1", "ignition.msgs.Pose_V");
  ASSERT_TRUE(run_until_delivered(3));
  source->stop();
  const std::size_t count = delivered_.size();
  run_for(std::chrono::milliseconds{200});
  EXPECT_EQ(delivered_.size(), count);
}

// One publication of the tool may be lost (gazebosim/gz-transport#586), so it runs until one arrives.
TEST_F(GazeboPoseSourceTest, TakesAPoseOfTheCommandLineTool) {
  const auto source = started("/tool");
  const auto deadline = std::chrono::steady_clock::now() + seconds{60};
  while (delivered_.empty() && std::chrono::steady_clock::now() < deadline) {
    ChildProcess tool{
        {GAZEBO_TOOL, "-t", "/tool", "-m", "ignition.msgs.Pose_V", "-p",
         "header { stamp { sec: 7 nsec: 5 } } pose { name: \"rov\" position { x: 1 y: 2 z: -3 } "
         "orientation { w: 1 z: 1 } }"}};
    run_until([&] { return !delivered_.empty() || tool.exit_status().has_value(); });
  }
  ASSERT_FALSE(delivered_.empty());
  expect_the_pose();
  EXPECT_EQ(delivered_.back().sample.time_ns, 7'000'000'005);
}

// Names that are invalid UTF-8, 50 per second: libprotobuf prints a line for each.
TEST_F(GazeboPoseSourceTest, LinesOfLibrariesGoToTheLogAndAreLimited) {
  const auto ring = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(1000);
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", ring));
  testing::internal::CaptureStderr();
  const auto source = started("/bytes");
  const ChildProcess other{
      {GAZEBO_PUBLISHER, "/bytes", "20", "1", "ignition.msgs.Pose_V", "r\xff", "1", "2", "3", "0", "0", "0"}};
  const auto complaints = [&] { return source->counters().bad_value + source->counters().malformed; };
  ASSERT_TRUE(run_until([&] { return complaints() > 100; }));
  std::cerr << "a library printed this" << std::endl;
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::IsEmpty());
  spdlog::set_default_logger(before);
  std::vector<std::string> lines = ring->last_formatted();
  std::erase_if(lines, [](const std::string& line) { return line.find("libprotobuf: ") == line.npos; });
  EXPECT_GE(lines.size(), 1U);
  EXPECT_LE(lines.size(), 20U);
  EXPECT_THAT(ring->last_formatted(),
              testing::Contains(testing::HasSubstr("library: a library printed this")));
}

TEST_F(GazeboPoseSourceTest, RefusesAnAddressThatIsNotOfThisMachine) {
  GazeboPoseInput input;
  input.topic = "/elsewhere";
  input.address = 0xC0000201;  // 192.0.2.1, of documents (RFC 5737)
  GazeboPoseSource source{io_, input, clock_, sink_};
  EXPECT_THROW(source.start(), Error);
}

TEST_F(GazeboPoseSourceTest, RefusesATopicThatIsNone) {
  GazeboPoseInput input;
  input.topic = "no topic";
  GazeboPoseSource source{io_, input, clock_, sink_};
  EXPECT_THROW(source.start(), Error);
}

}  // namespace
}  // namespace sonard::server
