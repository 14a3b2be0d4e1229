// SPDX-License-Identifier: Apache-2.0
// Where one turn of a scan ends and the next begins, and which lines are missing between.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/micron/host.hpp"

namespace sonard::client {

/// Once round, or in a sector once from one limit to the other, both included.
struct Turn {
  std::uint64_t number = 0;  ///< 0, 1, 2, ...
  std::vector<micron::ReceivedLine> lines;
  std::uint64_t lines_missed = 0;
};

/// Sorts lines into turns by their bearings, as docs/protocols/micron.md 8.3 says that they follow each
/// other. All round, a turn begins with whichever line comes first; in a sector at a limit, so the way there
/// belongs to none. Between a sector's turns the line at the limit belongs to both.
class ScanTurns {
 public:
  explicit ScanTurns(const micron::HeadCommand& parameters);

  /// The next line. Returns the turn that is complete with it, or was before it.
  std::optional<Turn> add(const micron::ReceivedLine& line);
  /// The head begins anew, from anywhere: the turn that was begun is given up.
  void restart();

  const Turn& current() const { return turn_; }
  /// False on the way to the first limit of a sector.
  bool begun() const { return begun_; }
  /// Share of the turn that is done, 0..1.
  double share() const;
  /// Lines that the head must have sent between those that came, over all.
  std::uint64_t lines_missed() const { return lines_missed_; }

 private:
  std::optional<Turn> add_all_round(const micron::ReceivedLine& line);
  std::optional<Turn> add_in_sector(const micron::ReceivedLine& line);
  void take(const micron::ReceivedLine& line);
  void count_missed(int way);
  Turn finish();
  int steps(int way) const;

  bool sector_;
  int step_;
  int left_ = 0;
  int length_;               ///< of a turn, in units
  bool clockwise_;           ///< the way the head turns now
  bool begun_ = true;        ///< false: on the way to the first limit
  std::optional<int> last_;  ///< all round: bearing of the last line; sector: its place from the left limit
  int travelled_ = 0;        ///< from the first line of the turn to the last
  Turn turn_;
  std::uint64_t lines_missed_ = 0;
};

}  // namespace sonard::client
