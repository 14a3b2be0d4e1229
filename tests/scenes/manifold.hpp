// SPDX-License-Identifier: Apache-2.0
// A subsea manifold with frame, headers, branches and valves, in any number of triangles.
#pragma once

#include <cstddef>

#include "renderer/scene/world.hpp"

namespace sonard::test {

/// 6 x 4 x 2.4 m, its base centred on the origin, x along the headers, z up. The facets are distributed by
/// area; their number is within 5 % of `triangles`, which must be at least 5000. No normals.
render::TriangleMesh make_manifold(std::size_t triangles);

}  // namespace sonard::test
