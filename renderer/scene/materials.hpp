// SPDX-License-Identifier: Apache-2.0
// The named acoustic materials, and the rules that turn the values of a world file into a material.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Names in the table of docs/worlds.md, in its order, without aliases.
std::vector<std::string> acoustic_material_names();

/// The material with this name or alias, under its first name in the table, if any. Letter
/// case and a numeric suffix from modelling tools ("Steel.001") are ignored.
std::optional<AcousticMaterial> find_acoustic_material(std::string_view name);

/// The most similar name in the table; empty if none is similar.
std::string similar_material_name(std::string_view name);

/// The values of a <sonard:material> element, as written there.
struct MaterialRequest {
  std::string name{};                           ///< may be empty
  std::optional<double> reflectance{};          ///< rho, >= 0
  std::optional<double> lambert_mu_db{};        ///< 10 log10 mu
  std::optional<double> pressure_reflection{};  ///< R, in [-1, 1]
  std::optional<double> rms_slope{};            ///< m, in [0.01, 0.5]
  std::optional<double> rms_height_mm{};        ///< sigma, in [0, 1000]
};

/// Returns the named material with the given numbers in place of its own. A name that is not in the table is
/// allowed if reflectance and mu are given. Without a name, it is the default material; if only the
/// reflectance is given, mu follows from it. All other values come from the default material, which has no
/// facets. A Lambert coefficient above 1/pi (more than all the energy) is lowered to 1/pi, and a reflectance
/// above 10 is kept; both add a line to `warnings`.
/// @throws WorldError if the name is unknown, or a number is not finite or out of range.
AcousticMaterial make_acoustic_material(const MaterialRequest& request, std::vector<std::string>& warnings);

/// Material for a <laser_retro> value: rho is the value, and mu is -22 dB + 20 log10(rho / 0.35), at most
/// 1/pi. 0 means "not set" in Gazebo and gives the default material.
/// @throws WorldError if the value is negative or not finite.
AcousticMaterial material_of_laser_retro(double laser_retro, std::vector<std::string>& warnings);

}  // namespace sonard::render
