// SPDX-License-Identifier: Apache-2.0
// Detects truncated files, and files of another kind. Most libraries read a truncated file up to its end,
// without an error.
#pragma once

#include <filesystem>

namespace sonard::render {

/// Compares the lengths in a file's header, or the mark that must end it, with its bytes. Knows PNG, JPEG,
/// BMP, TGA, PNM, GLB, 3DS, COLLADA and OpenSceneGraph's text format, by the extension; other formats pass.
/// Runs inside run_isolated(). Git LFS pointers, web pages and UTF-16 text are named, whatever the extension.
/// @throws std::runtime_error with the stated and the actual size
void require_complete(const std::filesystem::path& file);

}  // namespace sonard::render
