// What the two halves of SliceSampler share: seeing slices (slice_sampler.cpp) and refining them
// (slice_refinement.cpp).
#pragma once

#include <vector>

#include "renderer/visibility/slices/slice_sampler.hpp"

namespace sonard::render {

/// What stays the same during one ping.
struct SliceSampler::Setting {
  Fan fan;
  ElevationPattern pattern;
  const SurfaceModel& surface;
  const SliceAccuracy& accuracy;
  const std::vector<PartSurface>& parts;
  bool any_mapped;
  float line_m;

  float share_of_beam(const SliceCell& cell) const {
    return cell.slice.width_rad / static_cast<float>(fan.edge_rad(cell.beam) - fan.edge_rad(cell.beam + 1));
  }
};

/// Memory of one thread, and the way of one slice through it.
struct SliceSampler::Scratch {
  SliceCutter cutter;  ///< holds the triangles of one beam
  Segments segments;
  SliceSweep sweep;
  SlicePatcher patcher;
  const std::vector<VisiblePiece>* pieces = nullptr;

  void see(const Slice& slice, float tan_limit) {
    cutter.cut(slice, tan_limit, segments);
    pieces = &sweep.run(segments, tan_limit);
  }
  SlicePatcher::Request request(const Setting& setting, const Slice& slice) const {
    return {slice,
            segments,
            *pieces,
            cutter,
            setting.parts,
            setting.surface,
            setting.pattern,
            setting.fan.tan_limit(),
            setting.accuracy.evenness,
            setting.any_mapped,
            setting.line_m,
            setting.fan.max_range_m()};
  }
};

}  // namespace sonard::render
