// SPDX-License-Identifier: Apache-2.0
// gallery_pictures [NAME...]: draws the pictures of docs/gallery.md, each scene with effects off and as
// configured.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/pictures/gallery/scenes.hpp"
#include "tests/pictures/picture_program.hpp"

namespace {

using namespace sonard::pictures;

std::vector<Halves> halves_of(const std::vector<std::string>& names) {
  std::vector<Halves> all;
  for (const GalleryScene& scene : gallery_scenes()) {
    if (std::find(names.begin(), names.end(), scene.name) != names.end()) {
      const View view = view_of(scene);
      Halves halves{scene.name, view, "effects off", view, "as configured"};
      take_effects_off(halves.left);
      all.push_back(std::move(halves));
    }
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  PictureProgram program{.name = "gallery_pictures",
                         .description =
                             "Draws the scenes of docs/gallery.md, each with effects off on the left and as "
                             "configured on the right.",
                         .folder = SONARD_SOURCE_DIR "/docs/images/gallery",
                         .names = {},
                         .halves = halves_of};
  for (const GalleryScene& scene : gallery_scenes()) {
    program.names.push_back(scene.name);
  }
  return run_picture_program(program, argc, argv);
}
