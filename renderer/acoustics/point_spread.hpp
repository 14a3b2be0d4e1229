// SPDX-License-Identifier: Apache-2.0
// Effect of array and pulse on the mean echo, between the sampling of the world and the receiver.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/acoustics/beam_pattern.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The beam pattern and the pulse of one sonar, with the tables of its last settings. Mode `paper` uses no
/// pattern and no pulse.
class PointSpread {
 public:
  /// Makes the tables for these settings.
  /// @param skipped counts unchanged_settings, separate_beams and short_pulse
  void prepare(const SonarSettings& settings, std::uint64_t seed, int head, const SkipSwitches& skip,
               SkipCounts& skipped);

  /// True if the world must be sampled in fine beams, with sampled(), and form_beams() must join them.
  bool has_pattern() const { return uses_pattern_; }
  /// The settings with fine beams instead of beams.
  static SonarSettings sampled(const SonarSettings& settings);
  /// Joins fine beams to beams and stores the echoes of single points separately.
  void form_beams(const EchoImage& fine, const SonarSettings& settings, EchoImage& beams, WorkerPool& workers,
                  const SkipSwitches& skip, SkipCounts& skipped) const;

  /// Spreads the echo in range by the length of the pulse and multiplies it by the pulse's energy.
  void spread(EchoImage& echo, WorkerPool& workers);
  /// Spreads one value per line as spread() spreads the echo of a beam, without the pulse's energy if the
  /// pulse is short.
  void spread_lines(std::vector<float>& lines, WorkerPool& workers) const;

 private:
  struct PulseTable {
    PulseSettings made_of;
    double step_m;
    PulseResponse response;
  };

  void prepare_pattern(const SonarSettings& settings, std::uint64_t seed, int head, const SkipSwitches& skip,
                       SkipCounts& skipped);
  void prepare_pulse(const SonarSettings& settings, const SkipSwitches& skip, SkipCounts& skipped);

  std::optional<BeamPattern> pattern_;
  Aperture aperture_;  // of pattern_
  std::uint64_t seed_ = 0;
  bool uses_pattern_ = false;
  std::optional<PulseTable> pulse_;
  bool uses_pulse_ = false;
  double energy_ = 1;  ///< pulse_energy()
  EchoImage memory_;
};

}  // namespace sonard::render
