// SPDX-License-Identifier: Apache-2.0
// Shared parts of tests of pose sources: I/O on the test's thread, a clock and a sink.
#pragma once

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "server/pose/pose_source.hpp"
#include "tests/support/temporary_folder.hpp"
#include "tests/support/wait_for.hpp"

namespace sonard::server {

class SourceTest : public testing::Test {
 protected:
  struct Delivery {
    pose::PoseSample sample;
    TimePoint arrival;
  };

  /// Runs the I/O until the condition holds. @return false if it does not hold within the limit.
  bool run_until(const std::function<bool()>& condition,
                 std::chrono::milliseconds limit = std::chrono::seconds{10}) {
    return test::wait_for(
        [&] {
          io_.restart();
          io_.poll();
          return condition();
        },
        limit);
  }
  bool run_until_delivered(std::size_t count) {
    return run_until([&] { return delivered_.size() >= count; });
  }
  /// Runs the I/O for a while, so that a forbidden event would occur.
  void run_for(std::chrono::milliseconds time) {
    EXPECT_FALSE(run_until([] { return false; }, time));
  }

  static pose::PoseSample sample(std::int64_t time_ns) {
    pose::PoseSample result;
    result.time_ns = time_ns;
    return result;
  }
  /// A pose with a NaN, whose message decode() refuses as a bad value.
  static pose::PoseSample nan_sample() {
    pose::PoseSample result;
    result.T_world_vehicle.position_m.x = std::numeric_limits<double>::quiet_NaN();
    return result;
  }

  std::filesystem::path write_file(const std::string& text) const {
    const std::filesystem::path path = folder_.path() / "trajectory.csv";
    std::ofstream{path} << text;
    return path;
  }

  static constexpr Ipv4 localhost = 0x7F000001;
  static inline const AllowList loopback{{0x7F000000, 8}};

  test::TemporaryFolder folder_;
  boost::asio::io_context io_;
  SteadyClock clock_;
  std::vector<Delivery> delivered_;
  PoseSink sink_ = [this](const pose::PoseSample& sample, TimePoint arrival) {
    delivered_.push_back({sample, arrival});
  };
};

}  // namespace sonard::server
