// SPDX-License-Identifier: Apache-2.0
// What the two halves of SliceSampler share: seeing slices (slice_sampler.cpp) and refining them
// (slice_refinement.cpp).
#pragma once

#include <vector>

#include "renderer/engines/cpu/slice_sampler.hpp"

namespace sonard::render {

/// What stays the same during one ping.
struct SliceSampler::Setting {
  Fan fan;
  ElevationPattern pattern;
  SurfaceModel surface;
  SliceAccuracy accuracy;
  const std::vector<PartSurface>& parts;
  bool any_mapped;
  bool any_vertex_normals;
  bool any_facets;  ///< whether any part has them
  float line_m;
  SideView side_view;

  float share_of_beam(const SliceCell& cell) const {
    return cell.slice.width_rad / static_cast<float>(fan.edge_rad(cell.beam) - fan.edge_rad(cell.beam + 1));
  }
};

/// Memory of one thread, and the way of one slice through it.
struct SliceSampler::Scratch {
  SliceCutter cutter;  ///< holds the triangles of one beam
  Segments segments;
  SliceSweep sweep;
  SideExpectation expectation;
};

}  // namespace sonard::render
