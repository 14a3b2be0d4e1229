// SPDX-License-Identifier: Apache-2.0
// The directional response of the receive array: main lobes that overlap, side lobes, and what leaks into all
// beams by errors of the elements.
#pragma once

#include <cstddef>
#include <vector>

#include "renderer/acoustics/random.hpp"
#include "renderer/ping.hpp"
#include "renderer/skip_ledger.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

class PatternTable;

/// Fine beams that are sampled beyond either end of the fan: with Bearing::conical what lies there off the
/// horizontal appears nearer to the axis.
int fine_beams_beyond(const Aperture& aperture);

/// The edges of the fine beams that are sampled: each beam of the aperture in `fine_beams` parts of equal
/// sine, and those beyond.
std::vector<double> fine_beam_edges(const Aperture& aperture);

/// Power pattern P of the receive array over fine beams, incoherent (docs/physics.md 2.5):
///   I'[b][k] = c_b (sum_f P(s_f - s_b) I[f][k] + L sum_f I[f][k]),
/// s the sine of the bearing in the middle. The first sum runs over the directions in which a faultless array
/// receives more than -40 dB, with the errors of this array's elements; L is their mean power elsewhere. c_b
/// keeps the level of an echo that fills the fan evenly in angle.
///
/// A fine beam wider than 2 / elements in sine is taken at several points: sums of a pattern over points no
/// farther apart are its integral.
class BeamPattern {
 public:
  /// A pattern that changes nothing.
  BeamPattern() = default;
  /// @param aperture passes check_aperture(), with Azimuth::array and two beams or more
  BeamPattern(const Aperture& aperture, RandomKey elements);

  int fine_beams() const { return static_cast<int>(inverse_width_.size()); }
  /// Share of the echo of fine beam f that beam b receives.
  double share(int beam, int fine_beam) const;
  /// Beams, from the first to before the last.
  struct Beams {
    int begin = 0, end = 0;
  };
  /// The beams that receive some of these fine beams in their main lobe or the side lobes beside it.
  Beams receivers_of(int first_fine_beam, int last_fine_beam) const;
  /// Adds to each of these beams what those lobes receive of an echo in a fine beam.
  /// @param beams of as many numbers as there are beams
  void add_lobe(int fine_beam, float echo, const Beams& of, std::vector<float>& beams) const;
  /// The largest sum, of any beam, over what it receives of each fine beam more or less than it would with
  /// ideal edges: no bin changes by more than this times the strongest.
  double change() const { return change_; }

  /// @param fine echo of the fine beams
  /// @param out gets the beams; what it holds is used as memory
  /// @param skipped counts even_lines and perfect_elements
  void apply(const EchoImage& fine, EchoImage& out, WorkerPool& workers, const SkipSwitches& skip,
             SkipCounts& skipped) const;

 private:
  struct Band {
    int first = 0;  ///< fine beam
    int count = 0;
    std::size_t weights = 0;  ///< index of the first of them
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
  int beyond_ = 0;  ///< fine beams before those of the first beam
  std::vector<Band> bands_;
  std::vector<float> weights_;
  std::vector<float> inverse_width_;  ///< of fine beams, 1 / rad
  bool leaks_ = false;
  double change_ = 0.0;
};

}  // namespace sonard::render
