// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/device_fuzzer.hpp"

namespace sonard::fuzz {

void DeviceFuzzer::run_until(TimePoint target) {
  constexpr int most_wake_ups = 1000;
  for (int i = 0; i < most_wake_ups && last_.wake_at && *last_.wake_at <= target; ++i) {
    now_ = std::max(now_, *last_.wake_at);
    step(TimePassed{});
  }
  now_ = target;
  step(TimePassed{});
}

void DeviceFuzzer::step(const sonard::Event& event) {
  last_ = device().step(now_, event);
  stepped(event);
  for (const Outgoing& outgoing : last_.send) {
    check_message(outgoing);
  }
  if (last_.render) {
    const PingJob& job = *last_.render;
    require(!job_.has_value(), "one job at a time");
    require(job.native_bins > 0 && job.bins() > 0, "a job has bins");
    require(!plays_back() || job.record.has_value(), "a player renders nothing");
    check_job(job);
    job_ = job;
  }
  if (last_.record) {
    const RecordedSettings& settings = last_.record->settings;
    require(last_.record->samples.size() == static_cast<std::size_t>(settings.bins * settings.beams),
            "a record holds a whole ping");
    check_record(*last_.record);
  }
  require(!last_.cancelled || (job_ && job_->number == *last_.cancelled), "a cancelled job is unanswered");
  require(counters().pings_ended() <= counters().pings_started, "each ping has one end");
  require(!last_.wake_at || *last_.wake_at > now_, "the next deadline is later than now");
}

void DeviceFuzzer::begin_next() {
  if (last_.next_ping && last_.next_ping->from <= now_) {
    step(NextPingDue{});
  }
}

void DeviceFuzzer::answer_job(bool rendered) {
  const auto job = std::exchange(job_, std::nullopt);
  if (!job) {
    return;
  }
  if (!rendered || (job->bins() > most_bins() && !job->directions.any())) {
    step(PingNotRendered{job->number});
    return;
  }
  PingImage image;
  image.number = job->number;
  if (job->directions.any()) {
    const Directions& wanted = job->directions;
    image.directions = {wanted.columns, wanted.rows, std::vector<float>(wanted.count(), 2.0F),
                        std::vector<float>(wanted.count(), 1e-4F)};
    step(PingRendered{std::move(image)});
    return;
  }
  const int per_bin = job->beams > 0 ? job->beams : beams();
  const auto samples = static_cast<std::size_t>(job->bins()) * static_cast<std::size_t>(per_bin);
  if (job->sixteen_bit && !job->record) {
    image.u16.assign(samples, 0x1234);
  } else {
    image.u8.assign(samples, 0);
    for (std::size_t i = 0; i < samples; i += 7) {
      image.u8[i] = static_cast<std::uint8_t>(i);
    }
  }
  step(PingRendered{std::move(image)});
}

}  // namespace sonard::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const auto fuzzer = sonard::fuzz::make_device_fuzzer(data[0]);
  fuzzer->start();
  for (sonard::fuzz::Script script{{data + 1, size - 1}, fuzzer->byte_kinds()}; !script.done();) {
    fuzzer->play(script.next());
  }
  return 0;
}
