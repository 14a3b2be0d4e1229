// SPDX-License-Identifier: Apache-2.0
// Compares measurements with the project's targets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// Quality of the image of a timed ping. Its time counts only if the quality is sufficient.
struct Quality {
  double bin_rms, bin_rms_trim, first_echo_bins, hole_fraction, hole_fraction_60db;
};

enum class Verdict {
  not_measured,
  missed,
  error_unknown,   ///< fast enough, but there is no reference for the error
  error_too_high,  ///< fast enough, but the error is too high
  must_met,
  aim_met,
};

/// One line of the table. Smaller is better, unless `at_least`. Times are percentages of the time of
/// point_8x1024 in the same run. It traces 2 million rays in the same scene, so figures of different machines
/// can be compared.
struct TargetRow {
  std::string what;
  double must = 0;
  std::optional<double> aim;
  bool at_least = false;
  std::optional<double> measured;
  /// If the image counts too: the largest bin_rms allowed, and the measured quality.
  std::optional<double> rms_bound;
  std::optional<Quality> quality;
  std::optional<double> ms{};  ///< for times: milliseconds

  Verdict verdict() const;
};

/// Whether the image has an error within `rms_bound`, its first echo within half a bin, no hole above 1e-2 of
/// the beam's maximum, and at most .1 % holes above -60 dB.
bool keeps(const Quality& quality, double rms_bound);

/// Milliseconds of point_8x1024 on `cpu` in `scene`, or in swell100k if it was not measured there.
std::optional<double> point_time_ms(const Measurements& measurements, const std::string& scene);

/// All targets and the measurements of `engine`.
std::vector<TargetRow> target_rows(const Measurements& measurements, const std::string& engine);

/// The rows as a plain-text table.
std::string format_targets(const std::vector<TargetRow>& rows);

/// A measured point of error against number of samples.
struct SamplesAndError {
  double samples, error;
};

/// The number of samples for this error, by a power law through the two neighbouring points, or through the
/// last two if even the largest number has a larger error. nullopt if there are fewer than two points, or the
/// error does not decrease with more samples.
std::optional<double> samples_needed(std::vector<SamplesAndError> curve, double error);

}  // namespace sonard::bench
