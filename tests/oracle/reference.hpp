// SPDX-License-Identifier: Apache-2.0
// Reference images on disk: NAME.npy and NAME.json in tests/data/oracle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/oracle/echo_truth.hpp"

namespace sonard::oracle {

/// A stored image and its errors.
struct Reference {
  std::string scene;
  std::string scene_sha256;  ///< scene_hash() of the rendered scene
  std::uint64_t slices = 0;
  /// Relative error over the bins of RelativeError. The larger of the integrator's own estimate and the
  /// difference to a second run with another division of the beams.
  RelativeError error;
  /// Difference to rays with footprints on every `ray_check_stride`-th beam, and the rays' own estimate of
  /// their error; all 0 if not computed.
  int ray_check_stride = 0;
  RelativeError ray_check;
  RelativeError ray_error;
  /// Difference to an echo with spreading at the centre of each range line, as in the renderer.
  RelativeError line_centre;
  std::string command;  ///< command that creates this file

  int beams = 0;
  int lines = 0;
  std::vector<float> echo;  ///< [beam * lines + line]; see EchoTruth::echo
};

/// Writes the image as .npy (format 1.0, '<f4', C order, shape (beams, lines)), and beside it a .json with
/// the other values and the SHA-256 of the .npy.
/// @throws std::runtime_error if a file cannot be written
void write_reference(const std::filesystem::path& folder, const Reference& reference);

/// @throws std::runtime_error if a file is missing or invalid, or the image does not belong to the .json
Reference read_reference(const std::filesystem::path& folder, const std::string& scene);

}  // namespace sonard::oracle
