// SPDX-License-Identifier: Apache-2.0
#include "server/web/world_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "renderer/picture/picture_file.hpp"
#include "server/web/json.hpp"

namespace sonard::server {

using nlohmann::json;

namespace {

constexpr int longest_side_px = 1024;

/// Calls `take` with each corner of a body's meshes, in the body's frame.
template <class Take>
void each_corner(const render::Body& body, Take take) {
  for (const render::BodyPart& part : body.parts) {
    for (const glm::vec3& position : part.mesh->positions) {
      take(part.T_body_part * glm::dvec3(position));
    }
  }
}

void include(Extent& extent, bool& any, const glm::dvec3& p) {
  extent.min_m = any ? glm::min(extent.min_m, p) : p;
  extent.max_m = any ? glm::max(extent.max_m, p) : p;
  any = true;
}

Extent extent_of(const render::Body& body) {
  Extent extent;
  bool any = false;
  each_corner(body, [&](const glm::dvec3& p) { include(extent, any, body.T_world_body * p); });
  return extent;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Convex hull, counter-clockwise (Andrew's monotone chain, 1979).
std::vector<glm::dvec2> hull_of(std::vector<glm::dvec2> points) {
  std::ranges::sort(points, [](const glm::dvec2& a, const glm::dvec2& b) {
    return std::pair(a.x, a.y) < std::pair(b.x, b.y);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) {
    return points;
  }
  std::vector<glm::dvec2> hull;
  const auto half = [&](auto begin, auto end) {
    const std::size_t start = hull.size();
    for (auto point = begin; point != end; ++point) {
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), *point) <= 0) {
        hull.pop_back();
      }
      hull.push_back(*point);
    }
    hull.pop_back();  // the other half begins with this point
  };
  half(points.begin(), points.end());
  half(points.rbegin(), points.rend());
  return hull;
}

json outline_json(const render::Body& body, int across, int up) {
  std::vector<glm::dvec2> points;
  each_corner(body, [&](const glm::dvec3& p) { points.emplace_back(p[across], p[up]); });
  json outline = json::array();
  for (const glm::dvec2& point : hull_of(std::move(points))) {
    outline.push_back({point.x, point.y});
  }
  return outline;
}

std::size_t triangles_of(const render::Body& body) {
  std::size_t triangles = 0;
  for (const render::BodyPart& part : body.parts) {
    triangles += part.mesh->triangle_count();
  }
  return triangles;
}

/// An orthographic picture of triangles, with a depth for each pixel.
class Relief {
 public:
  Relief(const Extent& extent, ViewFrom from)
      : up_(from == ViewFrom::above ? 1 : 2),
        toward_(from == ViewFrom::above ? glm::dvec3(0, 0, 1) : glm::dvec3(0, -1, 0)),
        corner_(extent.min_m.x, extent.min_m[up_]) {
    const double width_m = std::max(extent.max_m.x - extent.min_m.x, 1e-3);
    const double height_m = std::max(extent.max_m[up_] - extent.min_m[up_], 1e-3);
    const double px_per_m = longest_side_px / std::max(width_m, height_m);
    width_ = std::max(1, static_cast<int>(std::lround(width_m * px_per_m)));
    height_ = std::max(1, static_cast<int>(std::lround(height_m * px_per_m)));
    scale_ = {width_ / width_m, height_ / height_m};
    nearness_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                     -std::numeric_limits<double>::infinity());
    grey_.assign(nearness_.size(), 0);
  }

  void draw(const std::array<glm::dvec3, 3>& corners) {
    const glm::dvec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double area = glm::length(across);
    if (!(area > 0)) {
      return;
    }
    const std::uint8_t grey = shade(across / area);
    std::array<glm::dvec2, 3> p;
    for (std::size_t i = 0; i < 3; ++i) {
      p[i] = (glm::dvec2(corners[i].x, corners[i][up_]) - corner_) * scale_;
    }
    const double twice_area = turn(p[0], p[1], p[2]);
    const auto [x0, x1] = pixels(p[0].x, p[1].x, p[2].x, width_);
    const auto [y0, y1] = pixels(p[0].y, p[1].y, p[2].y, height_);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const glm::dvec2 centre(x + 0.5, y + 0.5);
        const double a = turn(p[1], p[2], centre) / twice_area;
        const double b = turn(p[2], p[0], centre) / twice_area;
        const double c = 1 - a - b;
        // A triangle seen edge-on is drawn as a line.
        if (std::abs(twice_area) > 1e-9 && (a < 0 || b < 0 || c < 0)) {
          continue;
        }
        const glm::dvec3 at =
            std::abs(twice_area) > 1e-9 ? a * corners[0] + b * corners[1] + c * corners[2] : corners[0];
        put(x, y, glm::dot(at, toward_), grey);
      }
    }
  }

  std::string png() const {
    cv::Mat picture(height_, width_, CV_8UC4, cv::Scalar(0, 0, 0, 0));
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const std::size_t at = index(x, y);
        if (std::isfinite(nearness_[at])) {
          const std::uint8_t grey = grey_[at];
          picture.at<cv::Vec4b>(height_ - 1 - y, x) = {grey, grey, grey, 255};
        }
      }
    }
    return picture::png_file(picture, 1);
  }

 private:
  static std::pair<int, int> pixels(double a, double b, double c, int size) {
    return {std::clamp(static_cast<int>(std::floor(std::min({a, b, c}))), 0, size - 1),
            std::clamp(static_cast<int>(std::floor(std::max({a, b, c}))), 0, size - 1)};
  }

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  /// Both sides of a surface have the same shade.
  std::uint8_t shade(glm::dvec3 normal) const {
    if (glm::dot(normal, toward_) < 0) {
      normal = -normal;
    }
    glm::dvec3 light = 1.2 * toward_;
    light.x -= 0.6;
    light[up_] += 0.5;
    const double lit = std::max(0.0, glm::dot(normal, glm::normalize(light)));
    return static_cast<std::uint8_t>(std::lround(40 + 190 * lit));
  }

  void put(int x, int y, double nearness, std::uint8_t grey) {
    const std::size_t at = index(x, y);
    if (nearness > nearness_[at]) {
      nearness_[at] = nearness;
      grey_[at] = grey;
    }
  }

  int up_;               ///< the world axis that is up in the picture
  glm::dvec3 toward_;    ///< from the world to the viewer
  glm::dvec2 corner_;    ///< lower left, metres
  glm::dvec2 scale_{0};  ///< pixels per metre
  int width_ = 0, height_ = 0;
  std::vector<double> nearness_;  ///< by pixel, from the lowest row up; -infinity: empty
  std::vector<std::uint8_t> grey_;
};

}  // namespace

Extent extent_of(const render::World& world) {
  Extent extent;
  bool any = false;
  for (const render::Body& body : world.bodies) {
    each_corner(body, [&](const glm::dvec3& p) { include(extent, any, body.T_world_body * p); });
  }
  return extent;
}

json world_json(const render::World& world) {
  const Extent extent = extent_of(world);
  json bodies = json::array();
  for (const render::Body& body : world.bodies) {
    const Extent own = extent_of(body);
    json about = placed_json(body.T_world_body);
    about["name"] = body.name;
    about["triangles"] = triangles_of(body);
    about["top"] = outline_json(body, 0, 1);
    about["side"] = outline_json(body, 0, 2);
    about["min_m"] = vector_json(own.min_m);
    about["max_m"] = vector_json(own.max_m);
    bodies.push_back(std::move(about));
  }
  return {{"name", world.name},
          {"water_surface_z_m", world.water_surface_z_m ? json(*world.water_surface_z_m) : json(nullptr)},
          {"extent_m", {{"min", vector_json(extent.min_m)}, {"max", vector_json(extent.max_m)}}},
          {"bodies", std::move(bodies)}};
}

std::string world_png(const render::World& world, ViewFrom from) {
  Relief relief(extent_of(world), from);
  for (const render::Body& body : world.bodies) {
    for (const render::BodyPart& part : body.parts) {
      const render::Pose T_world_part = body.T_world_body * part.T_body_part;
      const render::TriangleMesh& mesh = *part.mesh;
      std::vector<glm::dvec3> positions;
      positions.reserve(mesh.positions.size());
      for (const glm::vec3& position : mesh.positions) {
        positions.push_back(T_world_part * glm::dvec3(position));
      }
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        relief.draw(
            {positions[mesh.indices[i]], positions[mesh.indices[i + 1]], positions[mesh.indices[i + 2]]});
      }
    }
  }
  return relief.png();
}

}  // namespace sonard::server
