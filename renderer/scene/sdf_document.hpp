// SPDX-License-Identifier: Apache-2.0
// An SDF file as a tree, with what it includes in the place of each <include>. Read with TinyXML-2 and not
// with libsdformat, which takes 2.5 MB and 13 ms a model, follows includes without an end, ends at SDF 1.9
// and is not everywhere; of a world's file only the shapes and their places are wanted here.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"
#include "renderer/scene/uri_resolver.hpp"

namespace sonard::render {

/// Reads `world_file` (absolute) and all it includes. Folders of included models are added to `resolver`. An
/// include that cannot be read, or that leads back to a file around it, is left out and goes to `problems`;
/// one whose file is not there to `warnings`, if it may be. A light that is not there is no problem.
/// @return the element <sdf>
/// @throws WorldError where nothing can be read: no XML, no <sdf>, more than a million elements
std::unique_ptr<SdfElement> read_sdf(const std::filesystem::path& world_file, UriResolver& resolver,
                                     MissingFiles missing, std::vector<std::string>& warnings,
                                     WorldProblems& problems);

}  // namespace sonard::render
