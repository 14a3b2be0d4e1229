// SPDX-License-Identifier: Apache-2.0
// A link that loses, delays, repeats and reorders datagrams as configured, for testing drivers.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/net/datagram.hpp"

namespace sonard::server {

/// Faults of one direction, drawn for each datagram.
struct LinkFaults {
  double loss = 0.0;                   ///< probability, [0, 1]
  double duplicate = 0.0;              ///< probability that a second copy is sent too, [0, 1]
  double reorder = 0.0;                ///< probability that the next datagram overtakes it, [0, 1]
  std::chrono::nanoseconds delay{0};   ///< added to each datagram, >= 0
  std::chrono::nanoseconds jitter{0};  ///< plus a uniform random value in [0, jitter], >= 0

  /// True if every datagram passes at once and unchanged.
  bool transparent() const {
    return loss == 0.0 && duplicate == 0.0 && reorder == 0.0 && delay.count() == 0 && jitter.count() == 0;
  }
};

/// Faults of the link between a head and its clients, for testing drivers. Seeded: the same datagrams in the
/// same order have the same faults.
struct LinkConfig {
  LinkFaults to_client;
  LinkFaults from_client;
  std::uint64_t seed = 1;
};

/// "to clients: 5 % lost, 20 ms later; from clients: 1 % twice"; empty if there are no faults.
std::string faults_text(const LinkConfig& link);

/// Counters; they only grow.
struct FaultyLinkCounters {
  std::uint64_t passed = 0;  ///< left the link, including second copies
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
};

/// One direction of a link. Pure: no socket, clock or thread. The faults of the n-th datagram depend only on
/// the seed and n, because five numbers are drawn for each, whatever the settings. So a run can be repeated.
/// Without jitter and reordering, the order is kept.
class FaultyLink {
 public:
  FaultyLink(const LinkFaults& faults, std::uint64_t seed);

  /// A datagram enters the link. `now` must not go backwards.
  void push(TimePoint now, Datagram datagram);
  /// Takes the datagrams that leave the link at or before `now`, in that order.
  std::vector<Datagram> take_due(TimePoint now);
  /// Next time at which take_due() has a datagram; nullopt: the link is empty.
  std::optional<TimePoint> next_due() const;

  const FaultyLinkCounters& counters() const { return counters_; }

 private:
  struct Held {
    Datagram datagram;
    TimePoint give_up;  ///< leaves at this time if no datagram has overtaken it
  };

  double draw();  ///< uniform in [0, 1)
  void release_held(TimePoint due);

  LinkFaults faults_;
  std::uint64_t random_state_;
  std::multimap<TimePoint, Datagram> in_flight_;  ///< equal times keep the order of insertion
  std::optional<Held> held_;
  FaultyLinkCounters counters_;
};

}  // namespace sonard::server
