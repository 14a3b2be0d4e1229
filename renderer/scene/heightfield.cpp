// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/heightfield.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace sonard::render {
namespace {

class Grid {
 public:
  Grid(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m)
      : image_(image),
        corner_m_(centre_m - glm::dvec3(0.5 * size_m.x, 0.5 * size_m.y, 0.0)),
        step_x_m_(size_m.x / (image.width_px - 1)),
        step_y_m_(size_m.y / (image.height_px - 1)) {
    const std::uint16_t brightest = *std::max_element(image.value.begin(), image.value.end());
    z_per_value_m_ = brightest > 0 ? size_m.z / brightest : 0.0;
  }

  double height_m(int x, int y) const {
    return image_.value[static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width_px) +
                        static_cast<std::size_t>(x)] *
           z_per_value_m_;
  }

  glm::dvec3 position(int x, int y) const {
    return corner_m_ + glm::dvec3(x * step_x_m_, y * step_y_m_, height_m(x, y));
  }

  /// Central differences, one-sided at the rim and at holes.
  glm::dvec3 normal(int x, int y) const {
    const int west = is_known(x - 1, y) ? x - 1 : x, east = is_known(x + 1, y) ? x + 1 : x;
    const int south = is_known(x, y - 1) ? y - 1 : y, north = is_known(x, y + 1) ? y + 1 : y;
    const double span_x = std::max(1, east - west) * step_x_m_,
                 span_y = std::max(1, north - south) * step_y_m_;
    return glm::normalize(glm::dvec3((height_m(west, y) - height_m(east, y)) / span_x,
                                     (height_m(x, south) - height_m(x, north)) / span_y, 1.0));
  }

 private:
  bool is_known(int x, int y) const {
    return x >= 0 && y >= 0 && x < image_.width_px && y < image_.height_px && !image_.is_hole(x, y);
  }

  const GreyImage& image_;
  glm::dvec3 corner_m_;
  double step_x_m_;
  double step_y_m_;
  double z_per_value_m_ = 0.0;
};

}  // namespace

void check_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m) {
  if (image.width_px < 2 || image.height_px < 2) {
    throw WorldError(
        fmt::format("heightmap of {} x {} pixels: expected at least 2 x 2", image.width_px, image.height_px));
  }
  const bool finite = std::isfinite(glm::length(size_m)) && std::isfinite(glm::length(centre_m));
  if (!finite || size_m.x <= 0.0 || size_m.y <= 0.0) {
    throw WorldError(
        fmt::format("heightmap size {} {} {}: expected x and y > 0", size_m.x, size_m.y, size_m.z));
  }
}

TriangleMesh make_heightfield(const GreyImage& image, const glm::dvec3& size_m, const glm::dvec3& centre_m) {
  check_heightfield(image, size_m, centre_m);
  const Grid grid(image, size_m, centre_m);
  TriangleMesh mesh;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      mesh.positions.emplace_back(grid.position(x, y));
      mesh.normals.emplace_back(grid.normal(x, y));
      mesh.texcoords.emplace_back(static_cast<double>(x) / (image.width_px - 1),
                                  static_cast<double>(y) / (image.height_px - 1));
    }
  }
  const auto width = static_cast<std::uint32_t>(image.width_px);
  const auto height = static_cast<std::uint32_t>(image.height_px);
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (!image.is_hole(a) && !image.is_hole(b) && !image.is_hole(c)) {
      mesh.indices.insert(mesh.indices.end(), {a, b, c});
    }
  };
  for (std::uint32_t y = 0; y + 1 < height; ++y) {
    for (std::uint32_t x = 0; x + 1 < width; ++x) {
      const std::uint32_t a = y * width + x;
      const std::uint32_t d = a + width;
      add(a, a + 1, d + 1);
      add(a, d + 1, d);
    }
  }
  return mesh;
}

}  // namespace sonard::render
