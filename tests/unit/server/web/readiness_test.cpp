// SPDX-License-Identifier: Apache-2.0
// The rules of docs/page.md: the pose of the vehicle is known, its stamps let pings begin, and each head
// serves an address.
#include <chrono>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/web/json.hpp"

namespace sonard::server {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::IsEmpty;

DaemonStatus ready_status() {
  DaemonStatus status;
  status.engine = "cpu";
  status.T_world_vehicle = render::Pose{};
  PoseInputStatus& input = status.inputs.emplace_back();
  input.input = "pose stream udp 127.0.0.1:14600";
  HeadStatus& head = status.heads.emplace_back();
  head.name = "bow";
  head.serves = {"udp 127.0.0.2:52901"};
  return status;
}

TEST(Readiness, NeedsNoClientAndNoPing) {
  EXPECT_THAT(why_not_ready(ready_status()), IsEmpty());
  EXPECT_EQ(
      readiness_json(ready_status()),
      json::parse(R"({"ready": true, "reasons": [], "engine": "cpu", "pose_known": true, "pose_age_s": null,
                            "heads": [{"name": "bow", "serves": ["udp 127.0.0.2:52901"], "clients": 0, "pings": 0,
                                       "last_ping_age_s": null}]})"));
}

TEST(Readiness, TellsAgesInSeconds) {
  DaemonStatus status = ready_status();
  status.inputs[0].poses.age = std::chrono::milliseconds{250};
  status.inputs.emplace_back().poses.age = std::chrono::milliseconds{40};
  status.heads[0].since_last_ping = std::chrono::seconds{90};
  const json answer = readiness_json(status);
  EXPECT_EQ(answer["pose_age_s"], 0.04) << "of the newest";
  EXPECT_EQ(answer["heads"][0]["last_ping_age_s"], 90.0);
}

TEST(Readiness, NamesWhatIsMissing) {
  DaemonStatus status = ready_status();
  status.T_world_vehicle.reset();
  status.heads.emplace_back().name = "stern";
  EXPECT_THAT(why_not_ready(status),
              ElementsAre("the vehicle has no pose: send poses to pose stream udp 127.0.0.1:14600",
                          "head 'stern' serves no address"));
  EXPECT_EQ(readiness_json(status)["ready"], false);
  status.inputs.clear();
  EXPECT_EQ(why_not_ready(status)[0], "the vehicle has no pose");
}

TEST(Readiness, SaysThatThePoseIsStale) {
  DaemonStatus status = ready_status();
  status.T_world_vehicle.reset();
  status.stale_pose = StalePose{std::chrono::milliseconds{2100}, std::chrono::milliseconds{500}};
  EXPECT_THAT(why_not_ready(status),
              ElementsAre("the pose is stale: the newest one is 2.1 s old, and poses.extrapolation_limit_ms "
                          "allows 500 ms: send poses to pose stream udp 127.0.0.1:14600"));
}

TEST(Readiness, NeedsStampsThatMoveWherePingsWaitForThem) {
  DaemonStatus status = ready_status();
  status.inputs[0].findings = {{"several_publishers", "2 publishers send poses at the same time."}};
  EXPECT_THAT(why_not_ready(status), IsEmpty()) << "pings are made all the same";
  status.inputs[0].findings.push_back({"stamps_never_moved", "The stamps have not changed.", true});
  EXPECT_THAT(why_not_ready(status),
              ElementsAre("pose stream udp 127.0.0.1:14600: The stamps have not changed."));
}

TEST(Readiness, NeedsAPoseOfAPublisherIfPingsWaitForStamps) {
  for (const PingClock clock : {PingClock::simulated, PingClock::simulated_lock_step}) {
    DaemonStatus status = ready_status();  // the pose is poses.initial
    status.ping_clock = clock;
    EXPECT_THAT(why_not_ready(status),
                ElementsAre("no pose has arrived, and pings follow the stamps of poses (poses.clock): send "
                            "poses to pose stream udp 127.0.0.1:14600"));
    status.inputs[0].poses.age = std::chrono::seconds{0};
    EXPECT_THAT(why_not_ready(status), IsEmpty());
  }
}

}  // namespace
}  // namespace sonard::server
