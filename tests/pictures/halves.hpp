// SPDX-License-Identifier: Apache-2.0
// Draws two views of one object side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/renderer_options.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::pictures {

struct Halves {
  std::string name;  ///< name of the file, without ".png"
  View left;
  std::string left_caption;
  View right;
  std::string right_caption;
};

/// Draws each pair into `folder`, which it creates if needed, and prints the name and size of its file. Make
/// all views before, because reading worlds must not happen beside drawing (configured_view()).
/// @param radius_px from the sonar to the full range
/// @throws std::runtime_error that names an unwritable file; the exceptions of draw_view()
void draw_halves(const std::vector<Halves>& all, const std::filesystem::path& folder,
                 render::EngineKind engine, int radius_px);

}  // namespace sonard::pictures
