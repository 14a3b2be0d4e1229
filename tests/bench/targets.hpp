// SPDX-License-Identifier: Apache-2.0
// What the project has promised, against what was measured.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// How good the image of a timed ping is, beside the bounds it has to keep for its time to count.
struct Quality {
  double bin_rms, bin_rms_trim, first_echo_bins, hole_fraction, hole_fraction_60db;
};

enum class Verdict {
  not_measured,
  missed,
  error_unknown,   ///< quick enough, but nothing to compare the image with
  error_too_high,  ///< quick enough, but not the image that was promised
  must_met,
  aim_met,
};

/// One line of the table. Smaller is better, or larger where `at_least`. What takes time is measured in
/// percent of the time of point_8x1024 in the same run, which traces 2 million rays in the same scene, so
/// that figures of different machines can be compared.
struct TargetRow {
  std::string what;
  double must = 0;
  std::optional<double> aim;
  bool at_least = false;
  std::optional<double> measured;
  /// Where the image counts too: the largest bin_rms allowed, and what was found.
  std::optional<double> rms_bound;
  std::optional<Quality> quality;
  std::optional<double> ms{};  ///< of what takes time

  Verdict verdict() const;
};

/// Does the image keep `rms_bound`, its first echo within half a bin, no hole above 1e-2 of the beam's
/// maximum and at most .1 % above -60 dB?
bool keeps(const Quality& quality, double rms_bound);

/// Milliseconds of point_8x1024 in `scene`, by `cpu`; where it was not measured there, in swell100k.
std::optional<double> point_time_ms(const Measurements& measurements, const std::string& scene);

/// All targets, as `engine` meets them.
std::vector<TargetRow> target_rows(const Measurements& measurements, const std::string& engine);

/// The rows as a table of plain text.
std::string format_targets(const std::vector<TargetRow>& rows);

/// A measured point of error against number of samples.
struct SamplesAndError {
  double samples, error;
};

/// How many samples bring the error down to `error`: a power law through the two neighbouring points, or
/// through the last two where even the largest is above. Empty with less than two points or where the error
/// does not fall with more samples.
std::optional<double> samples_needed(std::vector<SamplesAndError> curve, double error);

}  // namespace sonard::bench
