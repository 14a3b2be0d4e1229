// SPDX-License-Identifier: Apache-2.0
// Finds COLLADA documents with fewer numbers or vertices than they refer to (COLLADA 1.4.1, 5 and 6).
#pragma once

#include <string_view>

namespace sonard::render {

/// Compares `count` of <float_array>, <triangles> and <polylist> with the numbers in them. Assimp refuses a
/// difference, but OpenSceneGraph, the second reader, accepts it and reads the values that are there. Also
/// compares the indices of vertices in surfaces with their number: OpenSceneGraph returns no triangles if one
/// is too large. A document that tinyxml2 cannot parse passes.
/// @throws std::runtime_error with the line, the stated and the actual count, or the index and the count
void require_collada_counts(std::string_view document);

}  // namespace sonard::render
