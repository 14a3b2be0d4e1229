// SPDX-License-Identifier: Apache-2.0
#include "server/net/faulty_link.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sonard::server {
namespace {

// Limit for holding back a datagram for reordering, if no other one overtakes it.
constexpr TimePoint hold_limit = std::chrono::milliseconds{10};

// SplitMix64 (Steele, Lea, Flood 2014): every state is valid, so any seed is.
std::uint64_t next_random(std::uint64_t& state) {
  state += 0x9E3779B97F4A7C15u;
  std::uint64_t mixed = state;
  mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9u;
  mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBu;
  return mixed ^ (mixed >> 31);
}

}  // namespace

std::string faults_text(const LinkConfig& link) {
  std::vector<std::string> ways;
  for (const auto& [way, faults] :
       {std::pair{"to clients", link.to_client}, std::pair{"from clients", link.from_client}}) {
    std::vector<std::string> parts;
    for (const auto& [share, what] : {std::pair{faults.loss, "lost"}, std::pair{faults.duplicate, "twice"},
                                      std::pair{faults.reorder, "out of order"}}) {
      if (share > 0) {
        parts.push_back(fmt::format("{:.3g} % {}", 100 * share, what));
      }
    }
    const auto ms = [](std::chrono::nanoseconds time) { return 1e-6 * static_cast<double>(time.count()); };
    if (faults.delay.count() + faults.jitter.count() > 0) {
      parts.push_back(fmt::format(
          "{:.3g} ms{} later", ms(faults.delay),
          faults.jitter.count() > 0 ? fmt::format(" to {:.3g} ms", ms(faults.delay + faults.jitter)) : ""));
    }
    if (!parts.empty()) {
      ways.push_back(fmt::format("{}: {}", way, fmt::join(parts, ", ")));
    }
  }
  return fmt::format("{}", fmt::join(ways, "; "));
}

FaultyLink::FaultyLink(const LinkFaults& faults, std::uint64_t seed) : faults_(faults), random_state_(seed) {}

double FaultyLink::draw() {
  return static_cast<double>(next_random(random_state_) >> 11) * 0x1p-53;
}

void FaultyLink::push(TimePoint now, Datagram datagram) {
  // All numbers are drawn first: the faults of later datagrams must not depend on this one's.
  const bool lose = draw() < faults_.loss;
  const bool duplicate = draw() < faults_.duplicate;
  const bool reorder = draw() < faults_.reorder;
  const auto jitter_ns = static_cast<double>(faults_.jitter.count());
  const TimePoint due = now + faults_.delay + TimePoint{static_cast<std::int64_t>(jitter_ns * draw())};
  const TimePoint second_due = now + faults_.delay + TimePoint{static_cast<std::int64_t>(jitter_ns * draw())};

  if (lose) {
    ++counters_.lost;
    return;
  }
  if (reorder && !held_) {
    ++counters_.reordered;
    held_ = Held{std::move(datagram), due + hold_limit};
    return;
  }
  if (duplicate) {
    ++counters_.duplicated;
    in_flight_.emplace(second_due, datagram);
  }
  in_flight_.emplace(due, std::move(datagram));
  if (held_) {
    release_held(due);
  }
}

void FaultyLink::release_held(TimePoint due) {
  in_flight_.emplace(due, std::move(held_->datagram));
  held_.reset();
}

std::vector<Datagram> FaultyLink::take_due(TimePoint now) {
  if (held_ && held_->give_up <= now) {
    release_held(held_->give_up);
  }
  std::vector<Datagram> out;
  const auto end = in_flight_.upper_bound(now);
  for (auto it = in_flight_.begin(); it != end; ++it) {
    out.push_back(std::move(it->second));
  }
  in_flight_.erase(in_flight_.begin(), end);
  counters_.passed += out.size();
  return out;
}

std::optional<TimePoint> FaultyLink::next_due() const {
  std::optional<TimePoint> next;
  if (!in_flight_.empty()) {
    next = in_flight_.begin()->first;
  }
  if (held_) {
    next = next ? std::min(*next, held_->give_up) : held_->give_up;
  }
  return next;
}

}  // namespace sonard::server
