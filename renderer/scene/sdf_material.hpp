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

/// Refuses elements and attributes of the sonard namespace that are unknown, misplaced or there twice, so
/// that a typing error does not become a default. Each goes to `problems`, with its place.
void check_own_elements(const SdfElement& root, WorldProblems& problems);

/// "file:line: <sonar:material> is left out: ..." for each kind of element or attribute that looks like ours
/// and has a prefix that is not bound to our namespace, at its first place, with how often it comes.
std::vector<std::string> look_alikes(const SdfElement& root);

/// <sonard:material> directly inside `element`.
/// @throws WorldError without a place: the caller knows what the element is called
std::optional<AcousticMaterial> own_material(const SdfElement& element, std::vector<std::string>& warnings);

/// <sonard:material> of the nearest link or model around `element`.
/// @throws WorldError naming that link or model
std::optional<AcousticMaterial> inherited_material(const SdfElement& element,
                                                   std::vector<std::string>& warnings);

/// <sonard:water_surface_z> of a <world>, metres.
/// @throws WorldError "file:line: ..."
std::optional<double> water_surface_z_m(const SdfElement& world);

/// sonard:type of a <sensor type="custom">, which names a device; nullopt for any other element.
std::optional<std::string> sonar_type(const SdfElement& element);

}  // namespace sonard::render
