// SPDX-License-Identifier: Apache-2.0
// Divides a scan into sweeps and counts missing lines.
#pragma once

#include <cstdint>
#include <optional>

#include "clients/sonarview/common/sweep_pictures.hpp"
#include "protocol/micron/client.hpp"

namespace sonard::client {

/// Sorts lines into sweeps by their bearings (protocol/micron/README.md 8.3). A full turn begins with the
/// first line. In a sector, a sweep begins at a limit; lines before the first limit belong to no sweep. The
/// line at a limit belongs to both sweeps beside it.
class ScanSweeps {
 public:
  explicit ScanSweeps(const micron::HeadCommand& parameters);

  /// Adds the next line. Returns a sweep if this line completes it, or shows that it ended before this line.
  std::optional<Sweep> add(const micron::ReceivedLine& line);
  /// The head starts again at any bearing: drops the current sweep.
  void restart();

  const Sweep& current() const { return sweep_; }
  /// False before the first limit of a sector.
  bool begun() const { return begun_; }
  /// Share of the current sweep that has passed, 0..1.
  double share() const;
  /// Lines missing between received lines, in all sweeps.
  std::uint64_t lines_missed() const { return lines_missed_; }

 private:
  std::optional<Sweep> add_all_round(const micron::ReceivedLine& line);
  std::optional<Sweep> add_in_sector(const micron::ReceivedLine& line);
  void take(const micron::ReceivedLine& line);
  void count_missed(int way);
  Sweep finish();
  int steps(int way) const;

  bool sector_;
  int step_;
  int left_ = 0;
  int length_;               ///< of a sweep, in units of the head
  bool clockwise_;           ///< present direction of the head
  bool begun_ = true;        ///< false: before the first limit of a sector
  std::optional<int> last_;  ///< of the last line: its bearing, or in a sector its angle from the left limit
  int travelled_ = 0;        ///< angle from the start of the sweep to its last line
  Sweep sweep_;
  std::uint64_t lines_missed_ = 0;
};

}  // namespace sonard::client
