// effect_pictures [NAME...]: draws the pictures of docs/acoustics.md, each effect without and with it.
#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/pictures/draw_view.hpp"
#include "tests/pictures/effects/effects.hpp"
#include "tests/pictures/png_file.hpp"

namespace {

using namespace sonard;
using pictures::EffectPicture;

struct Halves {
  pictures::View before;
  pictures::View after;
};

/// Loads the worlds of all pictures, before the first renderer starts threads.
Halves halves_of(const EffectPicture& picture) {
  const pictures::View view = picture.view();
  Halves halves{view, view};
  picture.before(halves.before);
  picture.after(halves.after);
  return halves;
}

std::vector<EffectPicture> chosen(const std::vector<std::string>& names) {
  std::vector<EffectPicture> all = pictures::effect_pictures();
  for (const std::string& name : names) {
    if (std::none_of(all.begin(), all.end(), [&](const auto& picture) { return picture.name == name; })) {
      throw std::runtime_error(name + ": there is no such picture");
    }
  }
  if (!names.empty()) {
    std::erase_if(all, [&](const EffectPicture& picture) {
      return std::find(names.begin(), names.end(), picture.name) == names.end();
    });
  }
  return all;
}

void draw(const std::vector<EffectPicture>& chosen_pictures, const std::filesystem::path& folder,
          render::Backend backend, int radius_px) {
  std::vector<Halves> halves;
  for (const EffectPicture& picture : chosen_pictures) {
    halves.push_back(halves_of(picture));
  }
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < halves.size(); ++i) {
    const EffectPicture& picture = chosen_pictures[i];
    cv::Mat both;
    cv::hconcat(pictures::draw_view(halves[i].before, backend, radius_px, picture.caption_before),
                pictures::draw_view(halves[i].after, backend, radius_px, picture.caption_after), both);
    const std::filesystem::path file = folder / (picture.name + ".png");
    pictures::write_png(file, both);
    fmt::print("{} {} kB\n", file.string(), (std::filesystem::file_size(file) + 999) / 1000);
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> names;
  std::string folder = SONARD_SOURCE_DIR "/docs/images/acoustics";
  render::Backend backend = render::Backend::ray;
  int radius_px = 380;
  CLI::App app("Draws effects of docs/acoustics.md, each without it on the left and with it on the right.");
  app.add_option("names", names, "Pictures; all of them when none is named");
  app.add_option("--out", folder, "Folder for the pictures")->capture_default_str();
  app.add_option("--backend", backend, "Of the renderer")
      ->transform(CLI::CheckedTransformer(std::map<std::string, render::Backend>{
          {"ray", render::Backend::ray}, {"raster", render::Backend::raster}}));
  app.add_option("--radius", radius_px, "Pixels from the sonar to the full range")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    draw(chosen(names), folder, backend, radius_px);
  } catch (const std::exception& error) {
    fmt::print(stderr, "effect_pictures: {}\n", error.what());
    return 1;
  }
  return 0;
}
