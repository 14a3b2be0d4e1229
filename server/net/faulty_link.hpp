// SPDX-License-Identifier: Apache-2.0
// A link that loses, delays, repeats and swaps datagrams as configured, to test drivers with.
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

/// Faults put on datagrams of one direction, each drawn for each datagram.
struct LinkFaults {
  double loss = 0.0;                   ///< probability, [0, 1]
  double duplicate = 0.0;              ///< probability that a second copy goes too, [0, 1]
  double reorder = 0.0;                ///< probability to be held back behind the next datagram, [0, 1]
  std::chrono::nanoseconds delay{0};   ///< added to each datagram, >= 0
  std::chrono::nanoseconds jitter{0};  ///< plus a uniform draw from [0, jitter], >= 0

  /// True when every datagram passes at once and unchanged.
  bool transparent() const {
    return loss == 0.0 && duplicate == 0.0 && reorder == 0.0 && delay.count() == 0 && jitter.count() == 0;
  }
};

/// Faults of the link between a head and its clients, to test drivers with. Seeded: the same datagrams in
/// the same order have the same faults.
struct LinkConfig {
  LinkFaults to_client;
  LinkFaults from_client;
  std::uint64_t seed = 1;
};

/// "to clients: 5 % lost, 20 ms later; from clients: 1 % twice"; empty where nothing is put on any datagram.
std::string faults_text(const LinkConfig& link);

/// What the link has done so far; numbers only grow.
struct FaultyLinkCounters {
  std::uint64_t passed = 0;  ///< came out, second copies included
  std::uint64_t lost = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
};

/// One direction of a link. Pure: no socket, clock or thread. The faults of the n-th datagram depend on the
/// seed and n alone (five numbers are drawn for each, whatever the settings), so a run can be repeated.
/// Without jitter and reordering the order is kept.
class FaultyLink {
 public:
  FaultyLink(const LinkFaults& faults, std::uint64_t seed);

  /// A datagram enters the link. `now` never goes backwards.
  void push(TimePoint now, Datagram datagram);
  /// Takes the datagrams that come out at or before `now`, in that order.
  std::vector<Datagram> take_due(TimePoint now);
  /// When take_due() has something next; nullopt: the link is empty.
  std::optional<TimePoint> next_due() const;

  const FaultyLinkCounters& counters() const { return counters_; }

 private:
  struct Held {
    Datagram datagram;
    TimePoint give_up;  ///< leaves at this time when nothing has overtaken it
  };

  double draw();  ///< uniform in [0, 1)
  void release_held(TimePoint due);

  LinkFaults faults_;
  std::uint64_t random_state_;
  std::multimap<TimePoint, Datagram> in_flight_;  ///< equal times keep their order of insertion
  std::optional<Held> held_;
  FaultyLinkCounters counters_;
};

}  // namespace sonard::server
