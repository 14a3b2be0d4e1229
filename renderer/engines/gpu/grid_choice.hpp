// SPDX-License-Identifier: Apache-2.0
// How finely engine `gpu` samples each beam for an error preset (docs/accuracy.md).
#pragma once

#include <vector>

#include "renderer/engines/gpu/beam_estimate.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// How finely a beam is sampled: evenly, or more finely in a zone of it. Columns are even in number.
struct BeamDensity {
  int columns = 0;  ///< in the beam, or in the zone
  int rows = 0;     ///< over the height of the fan
  /// The zone, where there is one.
  double zone_port_rad = 0.0, zone_starboard_rad = 0.0;
  int port_columns = 0, starboard_columns = 0;  ///< beside the zone; 0: it ends where the beam ends

  bool has_zone() const { return zone_port_rad > zone_starboard_rad; }
  double samples() const { return 1.0 * (columns + port_columns + starboard_columns) * rows; }
  bool operator==(const BeamDensity&) const = default;
};

/// What a preset promises of every image (docs/physics.md 6).
struct GridTargets {
  double bins;     ///< relative RMS of bins above 1e-2 of their beam's maximum
  BeamError beam;  ///< of the worst beam
};

/// The targets of `fast` and `normal`; `reference` has those of `normal`.
GridTargets grid_targets(Sampling::Preset preset);

/// The estimated error from which on a beam is sampled again.
BeamError most_estimated_error(Sampling::Preset preset);

/// How often a preset samples at most. Of the last pass no errors are estimated. `reference` begins so finely
/// that a third pass changes no error by more than a hundredth of it (docs/accuracy.md).
int most_passes(Sampling::Preset preset);

/// The error of a beam's bins is taken to be this share of their distance to those of a quarter of the
/// samples: hardly ever is it more.
/// @param pass that the samples are of, from 1
double error_of_distance(Sampling::Preset preset, int pass);

/// Rows of a view over the height of the fan, at the finest.
int finest_rows(const Aperture& aperture);

/// Rows of the views in which two coplanar samples are binned as one: twice as many as `normal` begins with,
/// so that nothing is seen more coarsely than that.
int paired_rows(const Aperture& aperture);

/// The even grid that a preset begins with: fewer samples where it were more than 2^25.
/// @throws RequestError when the aperture cannot be gridded.
BeamDensity first_density(const Aperture& aperture, Sampling::Preset preset);

/// The beams [begin, end) of the aperture in one run, without a zone.
BeamRun even_run(const Aperture& aperture, int begin, int end, const BeamDensity& density);
/// All of them.
BeamRun whole_fan(const Aperture& aperture, const BeamDensity& density);

/// A beam and how finely it will be sampled.
struct BeamChoice {
  int beam = 0;
  BeamDensity density;
};

/// Neighbours that are sampled alike share views. Runs have 1, 2, 4 ... beams, so that views of few sizes
/// come back from ping to ping; a beam with a zone is one for itself.
/// @param choices in the order of beams.
std::vector<BeamRun> beam_runs(const Aperture& aperture, const std::vector<BeamChoice>& choices);

/// The runs with every second column and row only.
std::vector<BeamRun> thinned(std::vector<BeamRun> runs);

/// What is known of a beam.
struct BeamState {
  BeamDensity density;
  BeamEstimate estimate;
  double error_of_distance = 1.0;  ///< see error_of_distance()
  int columns = 0;                 ///< of all of the beam, as the estimate counts them
  /// The sides of the zone of the estimate.
  double zone_port_rad = 0.0, zone_starboard_rad = 0.0;
  int least_columns = 0;  ///< for the thin things in it (ThinThings), whatever is estimated
};

/// The beams that may miss the targets and can be sampled more finely, with how they are to be. Together they
/// take no more than 2^25 samples.
/// @param beams all beams of the aperture.
/// @param is_last whether they are for the last pass: what is too coarse then stays, so beams get more
std::vector<BeamChoice> beams_to_refine(const Aperture& aperture, const std::vector<BeamState>& beams,
                                        const GridTargets& targets, bool is_last);

}  // namespace sonard::render
