// SPDX-License-Identifier: Apache-2.0
// libsdformat, made strict and quiet: everything it would print or skip becomes an error or a warning of
// ours.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sdf/Element.hh>
#include <sdf/Root.hh>

#include "renderer/scene/uri_resolver.hpp"

namespace sonard::render {

/// "file:line" of the element, or of the nearest one around it whose line is known.
std::string place_of(const sdf::ElementPtr& element);

/// Parses `world_file` (absolute) with all it includes. Folders of included models are added to `resolver`;
/// what libsdformat warned of goes to `warnings`.
/// @throws WorldError "file:line: message" for the first error: XML, schema, an include that is missing or
/// that libsdformat took from elsewhere than docs/worlds.md says, more or less than one world.
sdf::Root parse_sdf(const std::filesystem::path& world_file, UriResolver& resolver,
                    std::vector<std::string>& warnings);

}  // namespace sonard::render
