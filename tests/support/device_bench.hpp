// SPDX-License-Identifier: Apache-2.0
// A head of any type in virtual time, with a renderer that takes a set time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/common/device.hpp"

namespace sonard {

/// Arbitrary values that differ between pings, bins and beams.
inline std::uint8_t test_sample(std::uint64_t ping, std::size_t bin, std::size_t beam = 0) {
  return static_cast<std::uint8_t>(ping * 31 + bin * 7 + beam);
}

/// Echoes from 1 m to 14 m; one direction in 16 has none.
inline DirectionRanges test_directions(std::uint64_t ping, const Directions& wanted) {
  DirectionRanges found{wanted.columns, wanted.rows, {}, {}};
  for (std::size_t i = 0; i < wanted.count(); ++i) {
    const std::uint8_t sample = test_sample(ping, i);
    found.range_m.push_back(sample % 16 == 0 ? 0.0F : 1.0F + 0.05F * static_cast<float>(sample));
    found.intensity.push_back(sample % 16 == 0 ? 0.0F : 1e-6F * static_cast<float>(sample));
  }
  return found;
}

/// An image of `bins` times `beams` test samples, or the directions that the job asks for.
inline PingImage test_image(const PingJob& job, int bins, int beams = 1) {
  PingImage image{job.number, {}, {}};
  if (job.directions.any()) {
    image.directions = test_directions(job.number, job.directions);
    return image;
  }
  for (std::size_t bin = 0; bin < static_cast<std::size_t>(bins); ++bin) {
    for (std::size_t beam = 0; beam < static_cast<std::size_t>(beams); ++beam) {
      const std::uint8_t sample = test_sample(job.number, bin, beam);
      if (job.sixteen_bit && !job.record) {
        image.u16.push_back(static_cast<std::uint16_t>(sample << 8 | (255 - sample)));
      } else {
        image.u8.push_back(sample);
      }
    }
  }
  return image;
}

/// Steps a head at the times that it requests, answers its jobs, and checks at each step that the head keeps
/// the promises of Actions about jobs and wake_at.
class DeviceBench {
 public:
  /// Does not step `head`, which must outlive the bench.
  DeviceBench(Device& head, std::function<PingImage(const PingJob&)> renders)
      : render(std::move(renders)), head_(head) {}
  virtual ~DeviceBench() = default;
  DeviceBench(const DeviceBench&) = delete;
  DeviceBench& operator=(const DeviceBench&) = delete;

  // Set by tests.
  std::chrono::nanoseconds render_time{0};
  std::function<PingImage(const PingJob&)> render;
  bool renderer_answers = true;  ///< false: the test answers the jobs itself
  bool renderer_fails = false;
  /// Delay of each timer of the head after its due time.
  std::function<std::chrono::nanoseconds()> lateness = [] { return std::chrono::nanoseconds{0}; };

  // Read by tests.
  TimePoint now{};
  std::vector<PingJob> jobs;
  std::vector<PingRecord> records;
  std::vector<Notice> notices;
  Actions last;  ///< of the last step

  void receive(const Peer& from, std::vector<std::uint8_t> bytes) {
    step(BytesReceived{from, SharedBytes(std::move(bytes))});
  }
  void answer(const PingImage& image) { step(PingRendered{image}); }
  void fail(std::uint64_t number) { step(PingNotRendered{number}); }
  /// Begins the ping that is due by now, as a server does in simulated time. Returns false if there is none.
  bool begin_next() {
    if (!last.next_ping || last.next_ping->from > now) {
      return false;
    }
    step(NextPingDue{});
    return true;
  }

  /// Time of the next event without input from the test.
  TimePoint next_event() const { return job_ ? std::min(timer_, job_->first) : timer_; }
  /// Runs until after the next event.
  void run_once() {
    now = std::max(now, next_event());
    if (job_ && job_->first <= now) {
      const PingJob job = std::exchange(job_, std::nullopt)->second;
      renderer_fails ? fail(job.number) : answer(render(job));
    } else {
      step(TimePassed{});
    }
  }
  void run_until(TimePoint end) {
    while (next_event() <= end) {
      run_once();
    }
    now = std::max(now, end);
  }
  void run_for(std::chrono::nanoseconds span) { run_until(now + span); }

  void step(const Event& event) {
    note_answer(event);
    last = head_.step(now, event);
    timer_ = TimePoint::max();
    if (last.wake_at) {
      EXPECT_GT(*last.wake_at, now) << "the head would keep its caller spinning";
      timer_ = *last.wake_at + lateness();
    }
    if (last.record) {
      records.push_back(*last.record);
    }
    notices.insert(notices.end(), last.notices.begin(), last.notices.end());
    for (const Outgoing& message : last.send) {
      hear(message);
    }
    if (last.render) {
      EXPECT_FALSE(unanswered_) << "a second job while one is unanswered";
      unanswered_ = last.render->number;
      jobs.push_back(*last.render);
      if (renderer_answers) {
        job_.emplace(now + render_time, *last.render);
      }
    }
    EXPECT_TRUE(!last.cancelled || last.cancelled == unanswered_) << "a cancelled job is unanswered";
    EXPECT_TRUE(!last.cancelled || !last.render);
  }

 protected:
  /// Called for each message as it is sent. It must not step the head.
  virtual void hear(const Outgoing& message) = 0;

 private:
  void note_answer(const Event& event) {
    const auto* const image = std::get_if<PingRendered>(&event);
    const auto* const failure = std::get_if<PingNotRendered>(&event);
    if ((image != nullptr && unanswered_ == image->image.number) ||
        (failure != nullptr && unanswered_ == failure->number)) {
      unanswered_.reset();
    }
  }

  Device& head_;
  TimePoint timer_ = TimePoint::max();
  std::optional<std::uint64_t> unanswered_;           ///< number of the outstanding job
  std::optional<std::pair<TimePoint, PingJob>> job_;  ///< with the time of its answer
};

}  // namespace sonard
