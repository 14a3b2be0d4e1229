// SPDX-License-Identifier: Apache-2.0
#include "tests/pictures/halves.hpp"

#include <fmt/format.h>

#include <opencv2/core.hpp>

#include "tests/pictures/draw_view.hpp"
#include "tests/pictures/png_file.hpp"

namespace sonard::pictures {

void draw_halves(const std::vector<Halves>& all, const std::filesystem::path& folder,
                 render::EngineKind engine, int radius_px) {
  std::filesystem::create_directories(folder);
  for (const Halves& halves : all) {
    cv::Mat both;
    cv::hconcat(draw_view(halves.left, engine, radius_px, halves.left_caption),
                draw_view(halves.right, engine, radius_px, halves.right_caption), both);
    const std::filesystem::path file = folder / (halves.name + ".png");
    write_png(file, both);
    fmt::print("{} {} kB\n", file.string(), (std::filesystem::file_size(file) + 999) / 1000);
  }
}

}  // namespace sonard::pictures
