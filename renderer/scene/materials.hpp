// SPDX-License-Identifier: Apache-2.0
// The named acoustic materials and the rules that make a material from what a world file says.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "renderer/scene/world.hpp"

namespace sonard::render {

/// Names of the table of docs/worlds.md, in its order, without aliases.
std::vector<std::string> acoustic_material_names();

/// The material of this name or alias, letter case and a numeric suffix as modelling tools add it
/// ("Steel.001") ignored; it has the table's first name. Empty when the table has none.
std::optional<AcousticMaterial> find_acoustic_material(std::string_view name);

/// The name of the table that looks most like `name`; empty when none is near.
std::string similar_material_name(std::string_view name);

/// What a <sonard:material> element says. Numbers are as written there.
struct MaterialRequest {
  std::string name{};                           ///< may be empty
  std::optional<double> reflectance{};          ///< rho, >= 0
  std::optional<double> lambert_mu_db{};        ///< 10 log10 mu
  std::optional<double> pressure_reflection{};  ///< R, in [-1, 1]
  std::optional<double> rms_slope{};            ///< m, in [0.01, 0.5]
  std::optional<double> rms_height_mm{};        ///< sigma, in [0, 1000]
};

/// The material that is asked for: the named one with the given numbers in place of its own; a name that is
/// not in the table is allowed when reflectance and mu are given; without a name, the default material, its
/// mu following from the reflectance when only that of the two is given. What else is not given is that of
/// the default material, which has no facets. A Lambert coefficient above 1/pi (more than all the energy) is
/// lowered to 1/pi and a reflectance above 10 is kept; both leave a line in `warnings`.
/// @throws WorldError for an unknown name, a number that is not finite or out of its range.
AcousticMaterial make_acoustic_material(const MaterialRequest& request, std::vector<std::string>& warnings);

/// Material for a <laser_retro> value: rho is the value, mu follows from it: -22 dB + 20 log10(rho / 0.35),
/// at most 1/pi. 0 means "not set" in Gazebo and gives the default material.
/// @throws WorldError when the value is negative or not finite.
AcousticMaterial material_of_laser_retro(double laser_retro, std::vector<std::string>& warnings);

}  // namespace sonard::render
