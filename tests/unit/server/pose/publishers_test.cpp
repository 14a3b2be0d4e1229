// SPDX-License-Identifier: Apache-2.0
// Programs that publish poses, as child processes: posecast and the Python example of docs/poses.md.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "server/net/addresses.hpp"
#include "server/pose/tcp/source.hpp"
#include "server/pose/udp/source.hpp"
#include "tests/unit/server/pose/child_process.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using test::ChildProcess;
using testing::ContainsRegex;
using testing::HasSubstr;

class PublishersTest : public SourceTest {
 protected:
  std::string file(const std::string& text) const { return write_file(text).string(); }
  /// A trajectory file: north at 2 m/s for half a second.
  std::string motion() const {
    return file("t,x,y,z,qx,qy,qz,qw\n0,0,0,-5,0,0,0,1\n0.25,0,0.5,-5,0,0,0,1\n0.5,0,1,-5,0,0,0,1\n");
  }
  int run(ChildProcess& child) {
    EXPECT_TRUE(run_until([&] { return child.exit_status().has_value(); }, std::chrono::seconds{30}));
    return child.exit_status().value_or(-1);
  }
  /// Checks that all poses are on the path of motion(), played at `speed`. The publisher may be slow, but its
  /// stamps must be right.
  void expect_motion(double speed) {
    ASSERT_GE(delivered_.size(), 2U);
    for (const Delivery& delivery : delivered_) {
      const double played_s =
          1e-9 * static_cast<double>(delivery.sample.time_ns - delivered_[0].sample.time_ns) * speed;
      const pose::Vec3& p = delivery.sample.T_world_vehicle.position_m;
      EXPECT_NEAR(p.y, std::min(2.0 * played_s, 1.0), 1e-6);
      EXPECT_EQ(p.z, -5.0);
    }
    ASSERT_TRUE(delivered_[0].sample.twist);
    EXPECT_NEAR(delivered_[0].sample.twist->linear_mps.y, 2.0 * speed, 1e-9);
    EXPECT_EQ(delivered_.back().sample.T_world_vehicle.position_m.y, 1.0) << "the last point is sent too";
  }
};

TEST_F(PublishersTest, PosecastByUdp) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  ChildProcess posecast{
      {POSECAST, motion(), "--to", endpoint_text(source.local_endpoint()), "--rate", "100"}};
  EXPECT_EQ(run(posecast), 0) << posecast.output();
  EXPECT_THAT(posecast.output(),
              ContainsRegex("^posecast: [0-9]+ poses in 0\\.[0-9]+ s to udp 127\\.0\\.0\\.1:"));
  expect_motion(1.0);
}

TEST_F(PublishersTest, PosecastByTcpAtDoubleSpeed) {
  TcpPoseSource source{io_, {{localhost, 0}, loopback, 8}, clock_, sink_};
  source.start();
  ChildProcess posecast{{POSECAST, motion(), "--tcp", "--to", endpoint_text(source.local_endpoint()),
                         "--rate", "100", "--speed", "2"}};
  EXPECT_EQ(run(posecast), 0) << posecast.output();
  EXPECT_TRUE(run_until([&] { return source.client_count() == 0; }));
  expect_motion(2.0);
}

// One pose per 10 ms of the file, from its first to its last stamp, at any speed. Every run therefore sends
// equal poses.
TEST_F(PublishersTest, PosecastSendsTheStampsOfTheFile) {
  TcpPoseSource source{io_, {{localhost, 0}, loopback, 8}, clock_, sink_};
  source.start();
  const std::string way = file("100.25 0 0 -5 0 0 0 1\n100.5 0 0.5 -5 0 0 0 1\n100.75 0 1 -5 0 0 0 1\n");
  for (const char* const speed : {"1000", "4"}) {
    delivered_.clear();
    ChildProcess posecast{{POSECAST, way, "--tcp", "--to", endpoint_text(source.local_endpoint()), "--rate",
                           "100", "--speed", speed, "--stamps", "file", "--quiet"}};
    EXPECT_EQ(run(posecast), 0);
    EXPECT_EQ(posecast.output(), "");
    ASSERT_EQ(delivered_.size(), 51U) << speed;
    for (std::size_t k = 0; k < delivered_.size(); ++k) {
      const pose::PoseSample& sample = delivered_[k].sample;
      EXPECT_EQ(sample.time_ns, 100'250'000'000 + 10'000'000 * static_cast<std::int64_t>(k));
      EXPECT_NEAR(sample.T_world_vehicle.position_m.y, 0.02 * static_cast<double>(k), 1e-9);
    }
    ASSERT_TRUE(delivered_[0].sample.twist);
    EXPECT_NEAR(delivered_[0].sample.twist->linear_mps.y, 2.0, 1e-9) << "metres per second of the file";
  }
}

// After the end of the file the path begins again, and the stamps continue.
TEST_F(PublishersTest, PosecastGoesOnWithTheStampsInALoop) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  ChildProcess posecast{{POSECAST, file("2 0 0 -5 0 0 0 1\n3 0 1 -5 0 0 0 1\n"), "--to",
                         endpoint_text(source.local_endpoint()), "--rate", "10", "--speed", "10", "--stamps",
                         "file", "--loop", "--from-time", "0.45", "--seconds", "1", "--hold", "0.1"}};
  EXPECT_EQ(run(posecast), 0) << posecast.output();
  const auto moving = std::ranges::find_if(
      delivered_, [](const Delivery& one) { return one.sample.time_ns > 2'450'000'000; });
  EXPECT_GT(moving - delivered_.begin(), 2) << "the first pose is held";
  ASSERT_EQ(delivered_.end() - moving, 9);
  for (std::int64_t k = 1; k < 10; ++k) {
    const pose::PoseSample& sample = moving[k - 1].sample;
    EXPECT_EQ(sample.time_ns, 2'450'000'000 + 100'000'000 * k);
    EXPECT_NEAR(sample.T_world_vehicle.position_m.y, std::fmod(0.45 + 0.1 * static_cast<double>(k), 1.0),
                1e-6);
  }
}

TEST_F(PublishersTest, PosecastConvertsNed) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  ChildProcess posecast{{POSECAST, file("0 10 20 30 0 0 0 1\n"), "--axes", "ned_frd", "--to",
                         endpoint_text(source.local_endpoint())}};
  EXPECT_EQ(run(posecast), 0) << posecast.output();
  ASSERT_EQ(delivered_.size(), 1U);
  EXPECT_EQ(delivered_[0].sample.T_world_vehicle.position_m.x, 20.0);
  EXPECT_EQ(delivered_[0].sample.T_world_vehicle.position_m.z, -30.0);
}

TEST_F(PublishersTest, PosecastLoopsUntilItsTimeIsUp) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  ChildProcess posecast{{POSECAST, motion(), "--loop", "--seconds", "0.8", "--from-time", "0.25",
                         "--no-twist", "--to", endpoint_text(source.local_endpoint())}};
  EXPECT_EQ(run(posecast), 0) << posecast.output();
  ASSERT_FALSE(delivered_.empty());
  EXPECT_EQ(delivered_[0].sample.T_world_vehicle.position_m.y, 0.5);
  EXPECT_FALSE(delivered_[0].sample.twist);
  const auto lasted =
      std::chrono::nanoseconds{delivered_.back().sample.time_ns - delivered_[0].sample.time_ns};
  EXPECT_LT(lasted, milliseconds{800});
  EXPECT_GT(lasted, milliseconds{600});
}

TEST_F(PublishersTest, PosecastEndsCleanlyOnCtrlC) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  ChildProcess posecast{{POSECAST, motion(), "--loop", "--to", endpoint_text(source.local_endpoint())}};
  ASSERT_TRUE(run_until_delivered(3));
  posecast.send(SIGINT);
  EXPECT_EQ(run(posecast), 0);
  EXPECT_THAT(posecast.output(), HasSubstr("posecast: "));
}

TEST_F(PublishersTest, PosecastSaysWhenTheReceiverGoesAway) {
  auto source =
      std::make_unique<TcpPoseSource>(io_, TcpPoseInput{{localhost, 0}, loopback, 8}, clock_, sink_);
  source->start();
  const std::string address = endpoint_text(source->local_endpoint());
  ChildProcess posecast{{POSECAST, motion(), "--loop", "--tcp", "--to", address}};
  ASSERT_TRUE(run_until_delivered(3));
  source.reset();
  EXPECT_EQ(run(posecast), 1);
  EXPECT_THAT(posecast.output(), HasSubstr("posecast: tcp " + address + ": "));
}

TEST_F(PublishersTest, PosecastSaysWhenNobodyListens) {
  Endpoint nobody;
  {
    UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
    source.start();
    nobody = source.local_endpoint();
  }
  ChildProcess udp{{POSECAST, motion(), "--to", endpoint_text(nobody)}};
  EXPECT_EQ(run(udp), 1);
  EXPECT_THAT(udp.output(), HasSubstr(": nothing listens there"));
  ChildProcess tcp{{POSECAST, motion(), "--tcp", "--to", endpoint_text(nobody)}};
  EXPECT_EQ(run(tcp), 1);
  EXPECT_THAT(tcp.output(), HasSubstr(": connect: Connection refused"));
}

TEST_F(PublishersTest, PosecastRefusesABadFileOrCommandLine) {
  const std::string bad = file("0 0 0 0 0 0 0 0\n");
  ChildProcess zero_quaternion{{POSECAST, bad}};
  EXPECT_EQ(run(zero_quaternion), 2);
  EXPECT_THAT(zero_quaternion.output(), HasSubstr("posecast: " + bad + ":1: orientation has a norm"));
  ChildProcess no_port{{POSECAST, motion(), "--to", "127.0.0.1"}};
  EXPECT_EQ(run(no_port), 2);
  EXPECT_THAT(no_port.output(), HasSubstr("--to: expected HOST:PORT"));
  ChildProcess too_late{{POSECAST, motion(), "--from-time", "0.6"}};
  EXPECT_EQ(run(too_late), 2);
}

TEST_F(PublishersTest, PythonExample) {
  UdpPoseSource source{io_, {{localhost, 0}, loopback}, clock_, sink_};
  source.start();
  setenv("PYTHONPATH", PYTHON_MODULES, 1);
  const Endpoint to = source.local_endpoint();
  ChildProcess example{{PYTHON, SONARD_SOURCE_DIR "/clients/examples/publish_pose.py", "--to", "127.0.0.1",
                        "--port", std::to_string(to.port), "--seconds", "0.5"}};
  EXPECT_EQ(run(example), 0) << example.output();
  ASSERT_GE(delivered_.size(), 5U) << example.output();
  EXPECT_EQ(source.counters().samples, delivered_.size()) << "every message was good";
  // The example drives a circle: its heading is along the tangent, and speed and turn rate agree with its
  // poses.
  const pose::PoseSample& first = delivered_.front().sample;
  const pose::PoseSample& last = delivered_.back().sample;
  ASSERT_TRUE(first.twist);
  const double seconds = 1e-9 * static_cast<double>(last.time_ns - first.time_ns);
  const pose::Transform expected = pose::advance(first.T_world_vehicle, *first.twist, seconds);
  const pose::Vec3 miss = expected.position_m - last.T_world_vehicle.position_m;
  EXPECT_LT(pose::norm(miss), 1e-6);
  EXPECT_GT(pose::norm(last.T_world_vehicle.position_m - first.T_world_vehicle.position_m), 0.05);
}

TEST(PosesPage, ShowsLinesOfTheTestedExample) {
  const auto text_of = [](const char* path) {
    std::ifstream file{path};
    return std::string{std::istreambuf_iterator<char>{file}, {}};
  };
  const std::string page = text_of(SONARD_SOURCE_DIR "/docs/poses.md");
  const std::string example = text_of(SONARD_SOURCE_DIR "/clients/examples/publish_pose.py");
  const std::size_t begin = page.find("```python\n") + 10;
  std::istringstream block{page.substr(begin, page.find("```", begin) - begin)};
  int lines = 0;
  for (std::string line; std::getline(block, line); ++lines) {
    EXPECT_THAT(example, HasSubstr(line + "\n"));
  }
  EXPECT_GT(lines, 8);
}

}  // namespace
}  // namespace sonard::server
