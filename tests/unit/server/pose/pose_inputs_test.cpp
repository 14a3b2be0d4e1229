// SPDX-License-Identifier: Apache-2.0
// Log lines about pose inputs.
#include "server/pose/pose_inputs.hpp"

#include <gmock/gmock.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <boost/asio/ip/udp.hpp>
#include <memory>
#include <regex>
#include <sstream>

#include "server/net/addresses.hpp"
#include "server/pose/tcp/input.hpp"
#include "server/pose/trajectory/input.hpp"
#include "server/pose/udp/input.hpp"
#include "tests/unit/server/pose/source_fixture.hpp"

namespace sonard::server {
namespace {

using std::chrono::milliseconds;

class PoseInputsTest : public SourceTest {
 protected:
  PoseInputsTest() {
    config_.inputs = {pose_input(UdpPoseInput{{localhost, 0}, loopback})};
    auto logger =
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_));
    before_ = spdlog::default_logger();
    spdlog::set_default_logger(std::move(logger));
    spdlog::set_pattern("%v");
  }
  ~PoseInputsTest() override { spdlog::set_default_logger(before_); }

  /// Number of matches of the pattern in the log.
  std::size_t said(const std::string& pattern) const {
    const std::string text = text_.str();
    const std::regex regex(pattern);
    return static_cast<std::size_t>(
        std::distance(std::sregex_iterator(text.begin(), text.end(), regex), std::sregex_iterator()));
  }
  void send(const PoseInputs& inputs) {
    const std::string description = inputs.source(0).description();
    const auto to = parse_endpoint(description.substr(description.rfind(' ') + 1));
    pose::PoseSample sample;
    sample.time_ns = ++sent_;
    boost::asio::ip::udp::socket socket(io_, {boost::asio::ip::udp::v4(), 0});
    const std::vector<std::uint8_t> bytes = pose::encode(sample);
    socket.send_to(boost::asio::buffer(bytes), {boost::asio::ip::address_v4(to->address), to->port});
  }

  PoseConfig config_;
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
  std::int64_t sent_ = 0;
};

TEST_F(PoseInputsTest, ReportsWhileItIsHeardAndTellsOfSilenceOnce) {
  PoseInputs inputs(io_, config_, clock_, sink_, PoseHold{}, milliseconds{40});
  inputs.start();
  EXPECT_EQ(said("pose stream udp 127\\.0\\.0\\.1:[0-9]+\n"), 1U) << text_.str();
  ASSERT_TRUE(run_until([&] { return said(": poses=0 .*age_ms=- ") == 1; })) << text_.str();
  run_for(milliseconds{200});
  EXPECT_EQ(said("poses=0 "), 1U) << text_.str();
  send(inputs);
  ASSERT_TRUE(run_until([&] { return said(": from 127\\.0\\.0\\.1:[0-9]+ poses=1 rate_hz") == 1; }))
      << text_.str();
  ASSERT_TRUE(run_until([&] { return said(": from 127\\.0\\.0\\.1:[0-9]+ poses=0 .*age_ms=[0-9]+ ") == 1; }))
      << text_.str();
  run_for(milliseconds{200});
  EXPECT_EQ(said("poses=0 "), 2U) << text_.str();
  EXPECT_EQ(delivered_.size(), 1U);
  EXPECT_THAT(inputs.publishers(0, clock_.now()), testing::ElementsAre(*inputs.source(0).publisher()));
  EXPECT_THAT(inputs.publishers(0, clock_.now() + std::chrono::seconds{3}), testing::IsEmpty());
  inputs.stop();
  EXPECT_EQ(said(": in total poses=1 "), 1U) << text_.str();
  EXPECT_EQ(said(": ended samples=1 malformed=0 bad_value=0 refused=0\n"), 1U) << text_.str();
}

TEST_F(PoseInputsTest, SaysNothingMoreOnceStopped) {
  PoseInputs inputs(io_, config_, clock_, sink_, PoseHold{}, milliseconds{20});
  inputs.start();
  inputs.stop();
  const std::string text = text_.str();
  run_for(milliseconds{100});
  EXPECT_EQ(text_.str(), text);
}

TEST_F(PoseInputsTest, EachConfiguredInputBecomesASource) {
  EXPECT_EQ(PoseInputs(io_, PoseConfig{}, clock_, sink_).size(), 0U);
  const auto file = write_file("t,x,y,z,qx,qy,qz,qw\n10,0,0,0,0,0,0,1\n10.3,0.3,0,0,0,0,0,1\n");
  config_.inputs.push_back(pose_input(TcpPoseInput{{localhost, 0}, loopback, 8}));
  config_.inputs.push_back(pose_input(TrajectoryInput{.file = file}));
  const PoseInputs inputs(io_, config_, clock_, sink_);
  ASSERT_EQ(inputs.size(), 3U);
  EXPECT_EQ(inputs.source(0).description(), "pose stream udp 127.0.0.1:0");
  EXPECT_EQ(inputs.source(1).description(), "pose stream tcp 127.0.0.1:0");
  EXPECT_EQ(inputs.source(2).description(), "pose trajectory " + file.string());
}

}  // namespace
}  // namespace sonard::server
