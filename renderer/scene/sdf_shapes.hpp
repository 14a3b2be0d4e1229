// SPDX-License-Identifier: Apache-2.0
// Shapes of SDF that need no file, and the numbers that they are given by.
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

// A child of `parent` as a value; each throws WorldError if it is no number.
glm::dvec3 vec3_of(const SdfElement& parent, std::string_view name, const glm::dvec3& otherwise);
double number_of(const SdfElement& parent, std::string_view name, double otherwise);
std::string text_of(const SdfElement& parent, std::string_view name);

/// The triangles of a shape that needs no file, with the sizes that SDF takes if none is given; nullopt: the
/// geometry is no such shape.
/// @throws WorldError
std::optional<TriangleMesh> primitive_of(const SdfElement& geometry);

/// How many triangles primitive_of() makes of it, without making them; 0 if it throws, or makes none.
std::size_t primitive_triangles(const SdfElement& geometry);

/// The sum over the shapes of a kind in the links of a model, or of all models in it.
std::size_t primitive_triangles_below(const SdfElement& element, std::string_view kind);

}  // namespace sonard::render
