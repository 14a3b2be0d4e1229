// SPDX-License-Identifier: Apache-2.0
// Sampling of the fan: adjacent planar views, the samples of their pixels, and the parts of pixels that
// belong to each beam.
#pragma once

#include <string>
#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// One planar view. A ray of the view is q(x, y) = axis + x * starboard + y * up with tangents x and y;
/// the axis lies in the sonar's xy plane at azimuth `azimuth_rad`. Pixel (column c, row j) is centred at
/// x = -tan_half_width + (c + 1/2) * pixel_width(), y = -tan_half_height + (j + 1/2) * pixel_height():
/// columns run to starboard, rows upwards.
struct SubView {
  double azimuth_rad = 0.0;  ///< psi of the axis, positive to port
  double tan_half_width = 0.0;
  double tan_half_height = 0.0;
  int columns = 0;
  int rows = 0;

  double pixel_width() const { return 2 * tan_half_width / columns; }
  double pixel_height() const { return 2 * tan_half_height / rows; }
};

/// The first surface on the ray of one pixel. With q the un-normalised ray of SubView, range_dx and range_dy
/// are the signed derivatives of the range by the tangents x and y on the plane of the surface hit
/// (docs/physics.md 2.3, equation 2). They use the geometric normal, never the shading normal.
struct SurfaceSample {
  float range_m = 0.0F;   ///< slant range to the first surface; 0: no surface; < 0: invalid
  float response = 0.0F;  ///< echo per solid angle at unit range; see SurfaceModel
  float range_dx = 0.0F;  ///< metres per unit tangent
  float range_dy = 0.0F;

  bool operator==(const SurfaceSample&) const = default;
};

/// The part of one pixel column inside one beam, cut at the beam's edges and at the elevation limit.
struct ColumnPart {
  int view = 0;
  int column = 0;
  float x_offset = 0.0F;  ///< centre of the part minus centre of the column, tangent units
  float width = 0.0F;     ///< tangent units
  int row_begin = 0;      ///< rows [row_begin, row_end) are inside the fan
  int row_end = 0;
  /// First and last row are cut: offset of the part's centre from the pixel centre, and its height.
  float first_y_offset = 0.0F, first_height = 0.0F;
  float last_y_offset = 0.0F, last_height = 0.0F;
  /// dy/dx of the upper elevation limit in this column; the lower one has the opposite slope.
  float limit_slope = 0.0F;
};

/// The sampling of one aperture: pure geometry, made once per configuration, the same for CPU and GPU.
struct SampleGrid {
  Aperture aperture;
  std::vector<SubView> views;
  std::vector<ColumnPart> parts;  ///< sorted by beam
  std::vector<int> beam_parts;    ///< parts of beam b: [beam_parts[b], beam_parts[b + 1])

  int beam_count() const { return static_cast<int>(beam_parts.size()) - 1; }
  /// Tangent x of the middle of a part, in its view.
  double middle(const ColumnPart& part) const;
  /// Azimuths of the two sides of a part.
  double port_rad(const ColumnPart& part) const;
  double starboard_rad(const ColumnPart& part) const;
  /// Solid angle times elevation pattern of the part's share of the pixel in this row, steradians.
  float weight(const ColumnPart& part, int row) const;
  /// Number of cells: pixels, each counted once per part.
  std::size_t cell_count() const;
};

/// SampleGrid::weight() of all cells, for binning on the CPU: with an elevation pattern they cost more than a
/// ping.
class CellWeights {
 public:
  explicit CellWeights(const SampleGrid& grid);
  /// Weights of a part, from its first row on.
  const float* of(std::size_t part) const { return &weights_[first_[part]]; }
  /// Sum of the weights of the parts [begin, end).
  double sum(std::size_t begin, std::size_t end) const;

 private:
  std::vector<float> weights_;
  std::vector<std::size_t> first_;  ///< first weight of each part, then the number of weights
};

/// Division of the fan into pixels. The defaults are accurate; other values reproduce the paper.
struct GridOptions {
  bool whole_columns = false;  ///< a column belongs to the beam that holds its centre
  bool elevation_mask = true;  ///< false: every row of a column counts

  bool operator==(const GridOptions&) const = default;
};

/// True if the settings require a grid of pixels: a fixed grid, samples without footprints, or one of the
/// paper's variants.
bool needs_grid(const SonarSettings& settings);

/// A sentence for the user about posts and bars that engine `gpu` may miss in some pings, because it draws a
/// grid for these settings; empty if it does not.
std::string missed_by_grid(const SonarSettings& settings);

/// Options for the model of `settings`.
GridOptions grid_options(const SonarSettings& settings);

/// The sampling of all beams.
/// @throws RequestError if aperture or sampling are out of range, or if a beam gets no column
SampleGrid make_sample_grid(const Aperture& aperture, const Sampling& sampling,
                            const GridOptions& options = {});

}  // namespace sonard::render
