// SPDX-License-Identifier: Apache-2.0
// Finds elements that SDF 1.3 to 1.12 does not have among shapes and their poses, so that a typing error does
// not silently give a default.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

/// Whether SDF has `child` in `parent`. True for elements of other namespaces ("gz:...") and for parents
/// whose contents sonard does not read.
bool is_known_child(std::string_view parent, std::string_view child);

/// "file:line: unknown element <colour> in <visual>: it is left out" for each kind of element that SDF does
/// not have in its parent, with its first place and its count. Elements of other namespaces ("gz:...") are
/// ignored.
std::vector<std::string> unknown_elements(const SdfElement& sdf);

}  // namespace sonard::render
