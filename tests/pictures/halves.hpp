// SPDX-License-Identifier: Apache-2.0
// Two views of one thing, side by side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "renderer/renderer_options.hpp"
#include "tests/pictures/view.hpp"

namespace sonard::pictures {

struct Halves {
  std::string name;  ///< of the file, without ".png"
  View left;
  std::string left_caption;
  View right;
  std::string right_caption;
};

/// Draws each into `folder`, which is made if needed, and prints the name and size of its file. Views are
/// made before, as reading worlds and drawing do not mix (configured_view()).
/// @param radius_px from the sonar to the full range
/// @throws std::runtime_error naming a file that cannot be written; what draw_view() throws
void draw_halves(const std::vector<Halves>& all, const std::filesystem::path& folder,
                 render::EngineKind engine, int radius_px);

}  // namespace sonard::pictures
