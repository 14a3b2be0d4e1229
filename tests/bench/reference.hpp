// SPDX-License-Identifier: Apache-2.0
// Reference images: closed forms if there is one, else images stored by the oracle.
#pragma once

#include <filesystem>
#include <optional>

#include "renderer/ping.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

struct Reference {
  render::EchoImage image;
  bool closed_form = false;
  /// The oracle's own estimate of its relative RMS error (as ImageError::bin_rms); nullopt for closed forms.
  std::optional<double> error_rms;
};

/// Reads a NumPy file of version 1.0 that holds little-endian float32 in C order, shape (beams, lines).
/// @throws std::runtime_error that names the file and the fault
render::EchoImage read_npy(const std::filesystem::path& file);

/// The image of a scene with one plane, in closed form.
/// @pre scene.plane has a value.
render::EchoImage plane_image(const test::Scene& scene);

/// The truth of a scene: its closed form, or `folder`/NAME.npy with the error in NAME.json beside it. nullopt
/// if neither exists.
/// @throws std::runtime_error if a stored reference cannot be read or has another size than the scene
std::optional<Reference> find_reference(const test::Scene& scene, const std::filesystem::path& folder);

}  // namespace sonard::bench
