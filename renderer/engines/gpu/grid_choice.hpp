// SPDX-License-Identifier: Apache-2.0
// Sampling density per beam of engine `gpu` for an error preset (docs/accuracy.md).
#pragma once

#include <vector>

#include "renderer/engines/gpu/beam_estimate.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Sampling density of a beam: even, or finer in a zone. Numbers of columns are even.
struct BeamDensity {
  int columns = 0;  ///< in the beam, or in the zone
  int rows = 0;     ///< over the height of the fan
  /// The sides of the zone, if there is one.
  double zone_port_rad = 0.0, zone_starboard_rad = 0.0;
  int port_columns = 0, starboard_columns = 0;  ///< beside the zone; 0: the zone ends with the beam

  bool has_zone() const { return zone_port_rad > zone_starboard_rad; }
  double samples() const { return 1.0 * (columns + port_columns + starboard_columns) * rows; }
  bool operator==(const BeamDensity&) const = default;
};

/// Accuracy that a preset guarantees for every image (docs/accuracy.md).
struct GridTargets {
  double bins;     ///< relative RMS of bins above 1e-2 of their beam's maximum
  BeamError beam;  ///< of the worst beam
};

/// The targets of a preset; `reference` has the targets of `normal`.
GridTargets grid_targets(Sampling::Preset preset);

/// The estimated error above which a beam is sampled again.
BeamError most_estimated_error(Sampling::Preset preset);

/// Largest number of passes. Errors of the last pass are not estimated. `reference` begins so finely that a
/// third pass would change no error by more than 1 % (docs/accuracy.md).
int most_passes(Sampling::Preset preset);

/// Assumed error of a beam's bins, as a share of their distance to the bins from a quarter of the samples.
/// The error is rarely larger.
/// @param pass of the samples, from 1
double error_of_distance(Sampling::Preset preset, int pass);

/// Largest number of rows of a view over the height of the fan.
int finest_rows(const Aperture& aperture);

/// Least number of rows of a view in which two coplanar samples are binned as one: twice the rows of the
/// first pass of `normal`, so that binning is never coarser than that pass.
int paired_rows(const Aperture& aperture);

/// The even grid of a preset's first pass, reduced to at most 2^25 samples.
/// @throws RequestError if the aperture is out of range
BeamDensity first_density(const Aperture& aperture, Sampling::Preset preset);

/// The beams [begin, end) of the aperture in one run, without a zone.
BeamRun even_run(const Aperture& aperture, int begin, int end, const BeamDensity& density);
/// All beams in one run, without a zone.
BeamRun whole_fan(const Aperture& aperture, const BeamDensity& density);

/// A beam and its next sampling density.
struct BeamChoice {
  int beam = 0;
  BeamDensity density;
};

/// Joins neighbours with equal density to runs, which share views. Runs have 1, 2, 4 ... beams, so that few
/// sizes of views recur from ping to ping. A beam with a zone has its own run.
/// @param choices in the order of beams
std::vector<BeamRun> beam_runs(const Aperture& aperture, const std::vector<BeamChoice>& choices);

/// The runs with every second column and row only.
std::vector<BeamRun> thinned(std::vector<BeamRun> runs);

/// State of a beam after a pass.
struct BeamState {
  BeamDensity density;
  BeamEstimate estimate;
  double error_of_distance = 1.0;  ///< see error_of_distance()
  int columns = 0;                 ///< of the whole beam, including both sides of a zone
  /// The sides of the zone of the estimate.
  double zone_port_rad = 0.0, zone_starboard_rad = 0.0;
  int least_columns = 0;  ///< for the thin things in it (ThinThings), independent of the estimate
};

/// The beams that may miss the targets and can be sampled more finely, with their next density. Together they
/// take at most 2^25 samples.
/// @param beams all beams of the aperture
/// @param is_last true for the last pass, in which beams get more samples because no pass follows
std::vector<BeamChoice> beams_to_refine(const Aperture& aperture, const std::vector<BeamState>& beams,
                                        const GridTargets& targets, bool is_last);

}  // namespace sonard::render
