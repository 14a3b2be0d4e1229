// SPDX-License-Identifier: Apache-2.0
// A fingerprint of all inputs of a reference image.
#pragma once

#include <string>

#include "renderer/pose.hpp"
#include "renderer/scene/world.hpp"
#include "renderer/sonar_settings.hpp"

namespace sonard::oracle {

/// SHA-256 (hexadecimal) over geometry, poses, materials, aperture, range lines and model. Lengths and
/// coordinates are rounded to 1e-6, rotations and angles to 1e-9, because sines differ in the last bit
/// between machines. Names, sampling and receiver are left out, because the mean echo does not depend on
/// them.
std::string scene_hash(const render::World& world, const render::Pose& T_world_sonar,
                       const render::SonarSettings& settings);

}  // namespace sonard::oracle
