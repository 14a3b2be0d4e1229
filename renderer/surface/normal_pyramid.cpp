// SPDX-License-Identifier: Apache-2.0
#include "renderer/surface/normal_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

constexpr float texel_scale = 32767.0F;

glm::vec3 unit_normal(const std::uint8_t* rgb) {
  const glm::vec3 n = glm::vec3(rgb[0], rgb[1], rgb[2]) / 127.5F - 1.0F;
  const float length = glm::length(n);
  return length > 0.1F ? n / length : glm::vec3(0.0F, 0.0F, 1.0F);
}

/// Which of `from` cells make up cell `i` of `to` cells, and their weights. An odd number of cells is not
/// divisible by two, so three cells can become one.
struct Share {
  int first = 0, count = 0;
  std::array<float, 3> weight{};

  Share(int i, int from, int to) {
    const double step = static_cast<double>(from) / to;
    const double begin = i * step;
    const double end = begin + step;
    first = static_cast<int>(begin);
    for (int cell = first; cell < from && cell < end - 1e-9 && count < 3; ++cell) {
      weight[static_cast<std::size_t>(count++)] =
          static_cast<float>((std::min(end, cell + 1.0) - std::max(begin, static_cast<double>(cell))) / step);
    }
  }
};

std::vector<glm::vec3> halved(const std::vector<glm::vec3>& normals, int width, int height, int new_width,
                              int new_height) {
  std::vector<glm::vec3> out;
  out.reserve(static_cast<std::size_t>(new_width) * static_cast<std::size_t>(new_height));
  for (int row = 0; row < new_height; ++row) {
    const Share rows(row, height, new_height);
    for (int column = 0; column < new_width; ++column) {
      const Share columns(column, width, new_width);
      glm::vec3 sum(0.0F);
      for (int j = 0; j < rows.count; ++j) {
        const glm::vec3* line =
            &normals[static_cast<std::size_t>(rows.first + j) * static_cast<std::size_t>(width)];
        for (int i = 0; i < columns.count; ++i) {
          sum += line[columns.first + i] * rows.weight[static_cast<std::size_t>(j)] *
                 columns.weight[static_cast<std::size_t>(i)];
        }
      }
      out.push_back(sum);
    }
  }
  return out;
}

}  // namespace

NormalPyramid NormalPyramid::straight() {
  NormalPyramid pyramid;
  pyramid.levels.push_back({1, 1, 0});
  pyramid.texels.push_back({0, 0, static_cast<std::int16_t>(texel_scale), 0});
  return pyramid;
}

NormalPyramid::NormalPyramid(const NormalMap& map) {
  std::vector<glm::vec3> normals;
  normals.reserve(map.rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < map.rgb.size(); i += 3) {
    normals.push_back(unit_normal(&map.rgb[i]));
  }
  int width = map.width_px;
  int height = map.height_px;
  while (true) {
    levels.push_back({width, height, texels.size()});
    for (const glm::vec3& n : normals) {
      const glm::vec3 scaled = glm::round(n * texel_scale);
      texels.push_back({static_cast<std::int16_t>(scaled.x), static_cast<std::int16_t>(scaled.y),
                        static_cast<std::int16_t>(scaled.z), 0});
    }
    if (width == 1 && height == 1) {
      break;
    }
    const int new_width = std::max(1, width / 2);
    const int new_height = std::max(1, height / 2);
    normals = halved(normals, width, height, new_width, new_height);
    width = new_width;
    height = new_height;
  }
}

glm::vec3 NormalPyramid::bilinear(const Level& level, const glm::vec2& uv) const {
  const glm::vec2 size(level.width_px, level.height_px);
  // uv is in [0, 1], so this is in [-1/2, size - 1/2].
  const glm::vec2 position = uv * size - 0.5F;
  const glm::vec2 corner = glm::floor(position);
  const glm::vec2 part = position - corner;
  const auto wrapped = [](int i, int n) { return i < 0 ? i + n : (i >= n ? i - n : i); };
  const int x0 = wrapped(static_cast<int>(corner.x), level.width_px);
  const int y0 = wrapped(static_cast<int>(corner.y), level.height_px);
  const int x1 = wrapped(x0 + 1, level.width_px);
  const int y1 = wrapped(y0 + 1, level.height_px);
  const auto texel = [&](int x, int y) {
    const Texel& t =
        texels[level.first_texel + static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width_px) +
               static_cast<std::size_t>(x)];
    return glm::vec3(t[0], t[1], t[2]);
  };
  const glm::vec3 low = glm::mix(texel(x0, y0), texel(x1, y0), part.x);
  const glm::vec3 high = glm::mix(texel(x0, y1), texel(x1, y1), part.x);
  return glm::mix(low, high, part.y) * (1.0F / texel_scale);
}

glm::vec3 NormalPyramid::mean_normal(const glm::vec2& uv, float level) const {
  const glm::vec2 inside = uv - glm::floor(uv);
  // In this form, a NaN level becomes 0.
  const float held = level > 0.0F ? std::min(level, static_cast<float>(levels.size() - 1)) : 0.0F;
  const auto low = static_cast<std::size_t>(held);
  const float part = held - static_cast<float>(low);
  const glm::vec3 fine = bilinear(levels[low], inside);
  return part > 0.0F ? glm::mix(fine, bilinear(levels[low + 1], inside), part) : fine;
}

glm::vec3 from_tangent_frame(const glm::vec3& m, const glm::vec3& vertex_normal, const glm::vec4& tangent) {
  const glm::vec3 n = glm::normalize(vertex_normal);
  const glm::vec3 along(tangent);
  const glm::vec3 t = glm::normalize(along - n * glm::dot(n, along));
  const glm::vec3 b = glm::cross(n, t) * tangent.w;
  return t * m.x + b * m.y + n * m.z;
}

}  // namespace sonard::render
