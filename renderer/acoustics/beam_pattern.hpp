// SPDX-License-Identifier: Apache-2.0
// The directional response of the receive array: main lobes that overlap, side lobes, and leakage into all
// beams caused by errors of the elements.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class PatternTable;

/// Number of fine beams sampled beyond each end of the fan. With Bearing::conical, objects there that are off
/// the horizontal appear nearer to the axis.
int fine_beams_beyond(const Aperture& aperture);

/// Edges of all sampled fine beams, in radians: each beam of the aperture in `fine_beams` parts of equal
/// sine, and the fine_beams_beyond() at either end.
std::vector<double> fine_beam_edges(const Aperture& aperture);

/// Power pattern P of the receive array over fine beams, incoherent (docs/physics.md 2.5):
///   I'[b][k] = c_b (sum_f P(s_f - s_b) I[f][k] + L sum_f I[f][k]),
/// s the sine of the bearing of the middle. The first sum runs over the directions in which a faultless array
/// receives more than -40 dB; P includes the errors of this array's elements. L is the mean power of the
/// errors elsewhere. c_b keeps the level of an echo that fills the fan evenly in angle.
///
/// A fine beam wider than 2 / elements in sine is sampled at several points: at that spacing the sum of a
/// pattern equals its integral.
class BeamPattern {
 public:
  /// A pattern that changes nothing.
  BeamPattern() = default;
  /// @param aperture passes check_aperture(), with Azimuth::array and two beams or more
  BeamPattern(const Aperture& aperture, RandomKey elements);

  int fine_beams() const { return static_cast<int>(inverse_width_.size()); }
  /// Share of the echo of a fine beam that a beam receives.
  double share(int beam, int fine_beam) const;
  /// Beams [begin, end).
  struct Beams {
    int begin = 0, end = 0;
  };
  /// The beams whose main lobe or side lobes beside it receive some of these fine beams.
  Beams receivers_of(int first_fine_beam, int last_fine_beam) const;
  /// Adds to each of these beams the part of a fine beam's echo that those lobes receive.
  /// @param beams one number per beam
  void add_lobe(int fine_beam, float echo, const Beams& of, std::vector<float>& beams) const;
  /// Largest sum, over the fine beams of any beam, of |share - ideal share|; an ideal beam has sharp
  /// edges. No bin changes by more than this times the strongest bin.
  double change() const { return change_; }

  /// @param fine echo of the fine beams
  /// @param out gets the beams; its memory is reused
  /// @param skipped counts even_bins and perfect_elements
  void apply(const EchoImage& fine, EchoImage& out, WorkerPool& workers, const SkipSwitches& skip,
             SkipCounts& skipped) const;

 private:
  struct Band {
    int first = 0;  ///< fine beam
    int count = 0;
    std::size_t weights = 0;  ///< index of the first weight
    float leak = 0.0F;        ///< c_b L
  };
  struct LineSums;
  struct Span;

  void add_band(const Aperture& aperture, int beam, const std::vector<double>& sines,
                const PatternTable& table);
  LineSums sum_lines(const EchoImage& fine, WorkerPool& workers) const;
  std::vector<Span> spans_of(const LineSums& sums, int lines, const SkipSwitches& skip,
                             SkipCounts& skipped) const;
  void receive(const EchoImage& fine, int beam, const Span& span, const float* leaks, float* out) const;

  int fine_per_beam_ = 1;
  int beyond_ = 0;  ///< fine beams before the first beam
  std::vector<Band> bands_;
  std::vector<float> weights_;
  std::vector<float> inverse_width_;  ///< of fine beams, 1 / rad
  bool leaks_ = false;
  double change_ = 0.0;
};

}  // namespace sonard::render
