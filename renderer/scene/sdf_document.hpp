// SPDX-License-Identifier: Apache-2.0
// Reads an SDF file as a tree, with the included content in place of each <include>. Uses TinyXML-2, not
// libsdformat, which takes 2.5 MB and 13 ms per model, follows includes without an end, stops at SDF 1.9 and
// is not available everywhere. sonard needs only shapes and their poses.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"
#include "renderer/scene/uri_resolver.hpp"

namespace sonard::render {

/// Reads `world_file` (absolute path) and all its includes. Folders of included models are added to
/// `resolver`. An include that cannot be read, or that includes itself, is left out and added to `problems`.
/// An include with a missing file is added to `warnings` if `missing` allows it. A missing light is no
/// problem.
/// @return the element <sdf>
/// @throws WorldError if nothing can be read: no XML, no <sdf>, more than a million elements
std::unique_ptr<SdfElement> read_sdf(const std::filesystem::path& world_file, UriResolver& resolver,
                                     MissingFiles missing, std::vector<std::string>& warnings,
                                     WorldProblems& problems);

}  // namespace sonard::render
