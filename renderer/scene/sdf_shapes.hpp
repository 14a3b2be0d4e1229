// SPDX-License-Identifier: Apache-2.0
// Shapes of SDF that need no file, and their numbers.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <glm/vec3.hpp>

#include "renderer/scene/sdf_tree.hpp"
#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Whether the model, or one inside it, has a shape of this kind.
/// @param kind "visual" or "collision"
bool has_shape(const SdfElement& model, std::string_view kind);

// A child of `parent` as a value; each throws WorldError if it is not a number.
glm::dvec3 vec3_of(const SdfElement& parent, std::string_view name, const glm::dvec3& otherwise);
double number_of(const SdfElement& parent, std::string_view name, double otherwise);
std::string text_of(const SdfElement& parent, std::string_view name);

/// The triangles of a shape that needs no file, with SDF's default sizes if none is given; nullopt for other
/// geometry.
/// @throws WorldError
std::optional<TriangleMesh> primitive_of(const SdfElement& geometry);

/// Number of triangles of primitive_of(), without making them; 0 if it throws or returns nullopt.
std::size_t primitive_triangles(const SdfElement& geometry);

/// The sum over the shapes of a kind in the links of a model, or in all models of a world.
std::size_t primitive_triangles_below(const SdfElement& element, std::string_view kind);

}  // namespace sonard::render
