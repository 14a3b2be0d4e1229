// SPDX-License-Identifier: Apache-2.0
// Reference images on disk: NAME.npy and NAME.json in tests/data/oracle.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/oracle/echo_truth.hpp"

namespace sonard::oracle {

/// A stored image and how far it may be off.
struct Reference {
  std::string scene;
  std::string scene_sha256;  ///< scene_hash() of what was rendered
  std::uint64_t slices = 0;
  /// Relative; see RelativeError for the bins they count. The larger of the integrator's own estimate and of
  /// the difference to a second run on another division of the beams.
  RelativeError error;
  /// Difference to rays and footprints on every `ray_check_stride`-th beam, and the error that the rays claim
  /// for themselves; all 0 when not made.
  int ray_check_stride = 0;
  RelativeError ray_check;
  RelativeError ray_error;
  /// Difference to the same echo with spreading taken at the centre of each range line, as the renderer does.
  RelativeError line_centre;
  std::string command;  ///< what makes this file

  int beams = 0;
  int lines = 0;
  std::vector<float> echo;  ///< [beam * lines + line]; see EchoTruth::echo
};

/// Writes the image as .npy (format 1.0, '<f4', C order, shape (beams, lines)) and the rest beside it as
/// .json with the SHA-256 of the .npy.
/// @throws std::runtime_error when a file cannot be written.
void write_reference(const std::filesystem::path& folder, const Reference& reference);

/// @throws std::runtime_error when a file is missing, is no such file, or the image is not the one the .json
/// belongs to.
Reference read_reference(const std::filesystem::path& folder, const std::string& scene);

}  // namespace sonard::oracle
