// SPDX-License-Identifier: Apache-2.0
// The table of `sonard_bench --quick`: times, their ratios to plain rays, errors, and the promises of
// presets.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/bench/measurements.hpp"

namespace sonard::bench {

/// One line of the table. Values that were not measured, or do not exist for this line, are not set.
struct QuickRow {
  std::string what;
  std::optional<double> ms{};
  /// The time in percent of point_8x1024 in the same scene and run. It traces 2 million rays, so this figure
  /// can be compared between machines.
  std::optional<double> percent_of_points{};
  std::optional<double> ratio{};  ///< of lines without a time
  std::optional<double> bin_rms{}, bin_rms_trim{}, first_echo_bins{}, hole_fraction_60db{};
  std::optional<double> promised_rms{};  ///< the largest bin_rms that the preset promises (docs/benchmark.md)
};

/// Milliseconds of point_8x1024 on `cpu` in `scene`, or in swell100k if it was not measured there.
std::optional<double> point_time_ms(const Measurements& measurements, const std::string& scene);

/// All lines, with the measurements of `engine`.
std::vector<QuickRow> quick_rows(const Measurements& measurements, const std::string& engine);

/// The measured rows as a plain-text table; empty if there are none.
std::string format_quick(const std::vector<QuickRow>& rows);

/// A measured point of error against number of samples.
struct SamplesAndError {
  double samples, error;
};

/// The number of samples for this error, by a power law through the two neighbouring points, or through the
/// last two if even the largest number has a larger error. nullopt if there are fewer than two points, or the
/// error does not decrease with more samples.
std::optional<double> samples_needed(std::vector<SamplesAndError> curve, double error);

}  // namespace sonard::bench
