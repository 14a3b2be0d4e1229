// SPDX-License-Identifier: Apache-2.0
#include "server/pose/pose_inputs.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>

#include "server/pose/pose_input.hpp"

namespace sonard::server {
namespace {

constexpr std::chrono::seconds at_once{2};
constexpr std::size_t most_publishers = 8;  // limit of tracked publishers

}  // namespace

PoseInputs::PoseInputs(boost::asio::io_context& io, const PoseConfig& config, const Clock& clock,
                       PoseSink sink, PoseHold hold, std::chrono::milliseconds report_period)
    : clock_(clock), ping_clock_(config.clock), report_period_(report_period), report_timer_(io) {
  const auto measured_sink = [&] {
    PoseStatistics& statistics =
        *statistics_.emplace_back(std::make_unique<PoseStatistics>(config.extrapolation_limit));
    return [this, &statistics, sink, index = statistics_.size() - 1](const pose::PoseSample& sample,
                                                                     TimePoint arrival) {
      statistics.observe(sample, arrival);
      note_publisher(index, arrival);
      sink(sample, arrival);
    };
  };
  for (const std::shared_ptr<const PoseInput>& input : config.inputs) {
    sources_.push_back(input->open(io, clock, measured_sink(), hold));
  }
  told_silent_.resize(sources_.size());
  publishers_.resize(sources_.size());
}

void PoseInputs::start() {
  for (const std::unique_ptr<PoseSource>& source : sources_) {
    source->start();
    spdlog::info("{}", source->description());
  }
  running_ = !sources_.empty();
  if (running_) {
    report_every_period();
  }
}

void PoseInputs::stop() {
  running_ = false;
  report_timer_.cancel();
  for (std::size_t i = 0; i < size(); ++i) {
    sources_[i]->stop();
    const PoseSourceCounters& done = sources_[i]->counters();
    const std::string name = sources_[i]->description();
    spdlog::info("{}: in total {}", name, to_string(statistics_[i]->in_all(clock_.now())));
    spdlog::info("{}: ended samples={} malformed={} bad_value={} refused={}{}", name, done.samples,
                 done.malformed, done.bad_value, done.refused, sources_[i]->details());
  }
}

void PoseInputs::note_publisher(std::size_t index, TimePoint now) {
  const std::optional<PublisherId> publisher =
      index < sources_.size() ? sources_[index]->publisher() : std::nullopt;
  if (!publisher) {
    return;
  }
  Publishers& publishers = publishers_[index];
  publishers.try_emplace(*publisher, Times{.first = now}).first->second.last = now;
  if (publishers.size() > most_publishers) {
    std::erase_if(publishers, [now](const auto& known) { return now - known.second.last > at_once; });
  }
  if (publishers.size() > most_publishers) {
    publishers.erase(publishers.begin());
  }
}

std::vector<PublisherId> PoseInputs::publishers(std::size_t index, TimePoint now) const {
  std::vector<PublisherId> recent;
  for (const auto& [publisher, times] : publishers_[index]) {
    // A publisher that fell silent before another began was restarted, with a new port.
    const bool replaced = std::ranges::any_of(
        publishers_[index], [last = times.last](const auto& other) { return other.second.first > last; });
    if (now - times.last <= at_once && !replaced) {
      recent.push_back(publisher);
    }
  }
  return recent;
}

void PoseInputs::report_every_period() {
  report_timer_.expires_after(report_period_);
  // Destroying this object also cancels the timer, which calls with an error.
  report_timer_.async_wait([this](const boost::system::error_code& error) {
    if (!error && running_) {
      report();
      report_every_period();
    }
  });
}

void PoseInputs::report() {
  for (std::size_t i = 0; i < size(); ++i) {
    const PoseStatistics::Summary recent = statistics_[i]->take(clock_.now());
    const bool silent = recent.poses == 0;
    if (!silent || !told_silent_[i]) {
      const std::optional<PublisherId> publisher = sources_[i]->publisher();
      spdlog::info("{}: {}{}", sources_[i]->description(),
                   publisher ? "from " + to_string(*publisher) + " " : "", to_string(recent));
    }
    told_silent_[i] = silent;
  }
}

}  // namespace sonard::server
