// SPDX-License-Identifier: Apache-2.0
// Our own elements in an SDF file, <sonard:material> and <sonard:water_surface_z>, and our own attribute,
// sonard:type of a <sensor>. Defined in docs/worlds.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "renderer/scene/sdf_tree.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Adds elements and attributes of the sonard namespace to `problems`, with their place, if they are unknown,
/// misplaced or repeated. A typing error then does not silently give a default.
void check_own_elements(const SdfElement& root, WorldProblems& problems);

/// "file:line: <sonar:material> is left out: ..." for each kind of element or attribute that looks like ours
/// but has a prefix without our namespace, with its first place and its count.
std::vector<std::string> look_alikes(const SdfElement& root);

/// Reads a <sonard:material> directly inside `element`.
/// @throws WorldError without a place: the caller adds it
std::optional<AcousticMaterial> own_material(const SdfElement& element, std::vector<std::string>& warnings);

/// Reads the <sonard:material> of the nearest link or model around `element`.
/// @throws WorldError with the name of that link or model
std::optional<AcousticMaterial> inherited_material(const SdfElement& element,
                                                   std::vector<std::string>& warnings);

/// <sonard:water_surface_z> of a <world>, metres.
/// @throws WorldError "file:line: ..."
std::optional<double> water_surface_z_m(const SdfElement& world);

/// sonard:type of a <sensor type="custom">, which names a device; nullopt for any other element.
std::optional<std::string> sonar_type(const SdfElement& element);

}  // namespace sonard::render
