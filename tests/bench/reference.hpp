// SPDX-License-Identifier: Apache-2.0
// Reference images: closed forms where there is one, else what the oracle has stored.
#pragma once

#include <filesystem>
#include <optional>

#include "renderer/ping.hpp"
#include "tests/scenes/scenes.hpp"

namespace sonard::bench {

struct Reference {
  render::EchoImage image;
  bool closed_form = false;
  /// What the oracle says of itself: relative RMS as ImageError::bin_rms. Empty for closed forms.
  std::optional<double> error_rms;
};

/// Reads a NumPy file of version 1.0 that holds little-endian float32 in C order, shape (beams, lines).
/// @throws std::runtime_error naming the file and what is wrong with it.
render::EchoImage read_npy(const std::filesystem::path& file);

/// The image that a scene made of one plane must give.
/// @pre scene.plane holds a value.
render::EchoImage plane_image(const test::Scene& scene);

/// The truth of a scene: its closed form, or `folder`/NAME.npy with the error in NAME.json beside it. Empty
/// when there is neither.
/// @throws std::runtime_error when a stored reference cannot be read or has another size than the scene asks
/// for.
std::optional<Reference> find_reference(const test::Scene& scene, const std::filesystem::path& folder);

}  // namespace sonard::bench
