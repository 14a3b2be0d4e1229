// SPDX-License-Identifier: Apache-2.0
// Which elements SDF 1.3 to 1.12 has where shapes and their places are given, so that a typing error does not
// become a default.
#pragma once

#include <string>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"

namespace sonard::render {

/// "file:line: <colour> in <visual> is not known: it is left out" for each kind of element that SDF does not
/// have in its parent, at its first place, with how often it comes. Elements of a namespace ("gz:...") are
/// another's business.
std::vector<std::string> unknown_elements(const SdfElement& sdf);

}  // namespace sonard::render
