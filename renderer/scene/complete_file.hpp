// SPDX-License-Identifier: Apache-2.0
// Finds files that are cut short. Most libraries read such a file as far as it goes, without an error.
#pragma once

#include <filesystem>

namespace sonard::render {

/// Compares the lengths that a file states in its own header, or the mark that must end it, with its bytes.
/// Knows PNG, JPEG, BMP, TGA, PNM, GLB, 3DS, COLLADA and OpenSceneGraph's text, by the extension; other
/// formats pass. Runs inside run_isolated().
/// @throws std::runtime_error saying what is promised and what is there
void require_complete(const std::filesystem::path& file);

}  // namespace sonard::render
