// SPDX-License-Identifier: Apache-2.0
// Divides a scan into sweeps and counts missing lines.
#pragma once

#include <cstdint>
#include <optional>

#include "clients/sonarview/common/sweep_pictures.hpp"
#include "protocol/micron/host.hpp"

namespace sonard::client {

/// Sorts lines into sweeps by their bearings (docs/protocols/micron.md 8.3). All round, a sweep begins with
/// the first line that comes; in a sector it begins at a limit, and the way there belongs to none. Between
/// two sweeps of a sector the line at the limit belongs to both.
class ScanSweeps {
 public:
  explicit ScanSweeps(const micron::HeadCommand& parameters);

  /// Adds the next line. Returns the sweep that is complete with it, or was before it.
  std::optional<Sweep> add(const micron::ReceivedLine& line);
  /// The head begins again, anywhere: drops the current sweep.
  void restart();

  const Sweep& current() const { return sweep_; }
  /// False on the way to the first limit of a sector.
  bool begun() const { return begun_; }
  /// Share of the sweep that is done, 0..1.
  double share() const;
  /// Lines that the head must have sent between those that came, over all.
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
  int length_;               ///< of a sweep, in units
  bool clockwise_;           ///< the way the head turns now
  bool begun_ = true;        ///< false: on the way to the first limit
  std::optional<int> last_;  ///< all round: bearing of the last line; sector: its place from the left limit
  int travelled_ = 0;        ///< from the first line of the sweep to the last
  Sweep sweep_;
  std::uint64_t lines_missed_ = 0;
};

}  // namespace sonard::client
