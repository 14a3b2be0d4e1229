// SPDX-License-Identifier: Apache-2.0
// The fixture of the suite: promises of protocol/common/device.hpp that every head keeps.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/protocol/contract/head.hpp"

namespace sonard::contract {

using namespace std::chrono_literals;

/// A head of the type under test, and everything that it has sent.
class HeadBench : public DeviceBench {
 public:
  explicit HeadBench(const HeadType& type, const Mode& mode = {}) : HeadBench(type.make(mode)) {}

  void connect() { head->connect(*this); }
  void request() { head->request(*this); }
  void cancel() { head->cancel(*this); }
  void leave() { head->leave(*this); }
  void feed(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
    ReplayedPing ping = head->recorded();
    ping.record = record;
    ping.due = due;
    step(PingFed{ping});
  }
  const PingCounters& counters() const { return head->counters(); }
  std::uint64_t ended() const { return counters().pings_ended(); }

  const std::unique_ptr<Head> head;
  std::vector<Outgoing> sent;

 protected:
  void hear(const Outgoing& message) override { sent.push_back(message); }

 private:
  explicit HeadBench(std::unique_ptr<Head> owned)
      : DeviceBench(owned->device(),
                    [beams = owned->beams(), recorded = owned->recorded().settings](const PingJob& job) {
                      return job.record ? test_image(job, recorded.bins, recorded.beams)
                                        : test_image(job, job.bins(), job.beams > 0 ? job.beams : beams);
                    }),
        head(std::move(owned)) {
    step(TimePassed{});
  }
};

struct Contract : ::testing::TestWithParam<HeadType> {};

inline std::string name_of(const ::testing::TestParamInfo<HeadType>& info) {
  return info.param.name;
}

}  // namespace sonard::contract
