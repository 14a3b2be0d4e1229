// SPDX-License-Identifier: Apache-2.0
// Types shared by the two halves of SliceSampler: visibility (slice_sampler.cpp) and refinement
// (slice_refinement.cpp).
#pragma once

#include <vector>

#include "renderer/engines/cpu/slice_sampler.hpp"

namespace sonard::render {

/// Tables of the elevation pattern. Pings with one aperture share them: they take as long as a quarter of a
/// narrow ping.
struct SliceSampler::Elevations {
  Aperture::Elevation elevation;
  double vertical_beamwidth_rad;
  ElevationPattern pattern;
  ProbeWeights probes;
};

/// Constants of one ping.
struct SliceSampler::Setting {
  Fan fan;
  const ElevationPattern& pattern;
  SurfaceModel surface;
  SliceAccuracy accuracy;
  const std::vector<PartSurface>& parts;
  bool any_mapped;
  bool any_vertex_normals;
  bool any_facets;  ///< some part has facets
  float line_m;
  SideView side_view;

  float share_of_beam(const SliceCell& cell) const {
    return cell.slice.width_rad / static_cast<float>(fan.edge_rad(cell.beam) - fan.edge_rad(cell.beam + 1));
  }
};

/// Memory of one thread: the stages of one slice.
struct SliceSampler::Scratch {
  SliceCutter cutter;  ///< holds the triangles of one beam
  Segments segments;
  SliceSweep sweep;
  SideExpectation expectation;
};

}  // namespace sonard::render
