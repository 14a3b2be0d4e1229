// SPDX-License-Identifier: Apache-2.0
// effect_pictures [NAME...]: draws the pictures of docs/acoustics.md, without and with each effect.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/pictures/effects/effects.hpp"
#include "tests/pictures/picture_program.hpp"

namespace {

using namespace sonard::pictures;

std::vector<Halves> halves_of(const std::vector<std::string>& names) {
  std::vector<Halves> all;
  for (const EffectPicture& picture : effect_pictures()) {
    if (std::find(names.begin(), names.end(), picture.name) != names.end()) {
      const View view = picture.view();
      Halves halves{picture.name, view, picture.caption_before, view, picture.caption_after};
      picture.before(halves.left);
      picture.after(halves.right);
      all.push_back(std::move(halves));
    }
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  PictureProgram program{.name = "effect_pictures",
                         .description =
                             "Draws effects of docs/acoustics.md, each without it on the left and with it "
                             "on the right.",
                         .folder = SONARD_SOURCE_DIR "/docs/images/acoustics",
                         .names = {},
                         .halves = halves_of};
  for (const EffectPicture& picture : effect_pictures()) {
    program.names.push_back(picture.name);
  }
  return run_picture_program(program, argc, argv);
}
