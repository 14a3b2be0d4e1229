// SPDX-License-Identifier: Apache-2.0
// `sonard check --listen`, with the Python example of docs/poses.md as the publisher, and with no publisher.
// publisher.
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/net/addresses.hpp"
#include "tests/support/loopback.hpp"
#include "tests/support/run_process.hpp"
#include "tests/unit/server/pose/child_process.hpp"

namespace sonard::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class Listen : public testing::Test {
 protected:
  ~Listen() override { std::filesystem::remove(config_); }

  std::string address() const { return address_text(own_loopback_address(3)); }

  ProcessResult listen_with(const std::string& poses) const {
    std::ofstream(config_) << "world: {file: " << SONARD_SOURCE_DIR
                           << "/tests/data/system/two_walls.sdf}\nposes: {" << poses
                           << "}\nheads:\n  - name: head\n    type: gemini_720i\n    sonar_id: 513\n"
                              "    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0}\n";
    return run_process({SONARD_PROGRAM, "check", "--no-network", "--listen", "1.5", config_});
  }
  ProcessResult listen(const std::string& more = "") const {
    return listen_with("udp: {bind: " + address() + ":14600" + more + "}");
  }
  ChildProcess publisher() const {
    setenv("PYTHONPATH", PYTHON_MODULES, 1);
    return ChildProcess{{PYTHON, SONARD_SOURCE_DIR "/clients/examples/publish_pose.py", "--to", address(),
                         "--seconds", "60"}};
  }

  std::string config_ = testing::TempDir() + "listen_" + std::to_string(getpid()) + ".yaml";
};

TEST_F(Listen, ShowsWhoSendsWhat) {
  const ChildProcess python = publisher();
  const ProcessResult result = listen();
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err << python.output();
  EXPECT_THAT(result.out, ContainsRegex("pose stream udp " + address() + ":14600 from 127[0-9.]*:[0-9]+\n"));
  EXPECT_THAT(result.out,
              ContainsRegex("  poses=[0-9]+ rate_hz=[0-9.]+ time_rate=(0\\.9|1\\.0)[0-9] age_ms=[0-9]+ "
                            "longest_gap_ms=[0-9]+ gaps=0 jumps=0 clock_restarts=0\n"));
  // It moves on a circle of 10 m at 20 m depth, from due east to the north.
  EXPECT_THAT(result.out,
              ContainsRegex(
                  "  vehicle  last at \\((9\\.9|10\\.0)[0-9]+, [0-9.]+, -20\\.000\\) m east, north, up; roll "
                  "0\\.0, pitch -?0\\.0, yaw 9[0-9]\\.[0-9] degrees; "));
}

TEST_F(Listen, SaysThatNothingArrivesAndWhatToLookAt) {
  const ProcessResult result = listen();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.out, HasSubstr("no pose of the vehicle: nothing arrived: is the publisher running"));
}

TEST_F(Listen, SaysThatASenderIsNotAllowed) {
  const ChildProcess python = publisher();
  const ProcessResult result = listen(", allow: [10.0.0.0/8]");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.out,
              HasSubstr("no pose of the vehicle: all messages were refused: is the sender in the `allow`"));
  EXPECT_THAT(result.err, HasSubstr("not in the allow list"));
}

TEST_F(Listen, WantsAnInputToListenTo) {
  const ProcessResult result = listen_with("initial: {position_m: [0, 0, 0]}");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.out, HasSubstr("nothing to listen to"));
  EXPECT_THAT(result.out, Not(HasSubstr("listening")));
}

}  // namespace
}  // namespace sonard::test
