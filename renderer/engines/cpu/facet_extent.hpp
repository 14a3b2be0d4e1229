// SPDX-License-Identifier: Apache-2.0
// The ranges of a facet within the wedge of a slice (Sampling::within_facets).
#pragma once

#include <optional>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/cpu/slice_cutter.hpp"

namespace sonard::render {

struct FacetExtent {
  float nearest_m = 0.0F, furthest_m = 0.0F;
};

/// The exact extent of the part of a triangle that is in the wedge; nullopt if no part is.
/// @param slice narrower than half a turn
std::optional<FacetExtent> facet_extent(const FanTriangle& triangle, const Slice& slice);

/// Cuts off the ranges of a patch beyond an extent.
void keep_within(const FacetExtent& extent, EchoPatch& patch);

}  // namespace sonard::render
