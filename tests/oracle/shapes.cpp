// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

namespace sonard::oracle {

namespace {

constexpr double no_hit = std::numeric_limits<double>::infinity();

SurfaceHit smooth_hit(double range_m, const glm::dvec3& normal, const Material& material) {
  return {range_m, normal, normal, material};
}

class Plane : public Surface {
 public:
  Plane(const glm::dvec3& point, const glm::dvec3& normal, const Material& material)
      : distance_(glm::dot(point, normal)), normal_(normal), material_(material) {}

  SurfaceHit nearest(const glm::dvec3& direction) const override {
    const double range = distance_ / glm::dot(normal_, direction);
    return range > 0 && range < no_hit ? smooth_hit(range, normal_, material_) : SurfaceHit{};
  }

 private:
  double distance_;
  glm::dvec3 normal_;
  Material material_;
};

class ThinWall : public Surface {
 public:
  ThinWall(const glm::dvec3& centre, const glm::dvec3& half_u, const glm::dvec3& half_v,
           const Material& material)
      : centre_(centre),
        half_u_(half_u),
        half_v_(half_v),
        plane_(centre, glm::normalize(glm::cross(half_u, half_v)), material) {}

  SurfaceHit nearest(const glm::dvec3& direction) const override {
    const SurfaceHit hit = plane_.nearest(direction);
    if (!hit.is_hit()) {
      return hit;
    }
    const glm::dvec3 offset = hit.range_m * direction - centre_;
    const bool inside = std::abs(glm::dot(offset, half_u_)) <= glm::dot(half_u_, half_u_) &&
                        std::abs(glm::dot(offset, half_v_)) <= glm::dot(half_v_, half_v_);
    return inside ? hit : SurfaceHit{};
  }

 private:
  glm::dvec3 centre_, half_u_, half_v_;
  Plane plane_;
};

class Sphere : public Surface {
 public:
  Sphere(const glm::dvec3& centre, double radius, const Material& material)
      : centre_(centre), radius_(radius), material_(material) {}

  SurfaceHit nearest(const glm::dvec3& direction) const override {
    const double along = glm::dot(centre_, direction);
    const glm::dvec3 across = centre_ - along * direction;
    const double chord_squared = radius_ * radius_ - glm::dot(across, across);
    if (chord_squared < 0) {
      return {};
    }
    const double half_chord = std::sqrt(chord_squared);
    const double range = along - half_chord > 0 ? along - half_chord : along + half_chord;
    return range > 0 ? smooth_hit(range, (range * direction - centre_) / radius_, material_) : SurfaceHit{};
  }

 private:
  glm::dvec3 centre_;
  double radius_;
  Material material_;
};

/// A shape that intersects rays in its own frame.
class PlacedShape : public Surface {
 public:
  PlacedShape(const render::Pose& T_sonar_shape, const Material& material)
      : T_sonar_shape_(T_sonar_shape),
        origin_(render::inverse(T_sonar_shape).position_m),
        material_(material) {}

  SurfaceHit nearest(const glm::dvec3& direction) const override {
    glm::dvec3 normal(0);
    const double range = meet(origin_, glm::conjugate(T_sonar_shape_.orientation) * direction, normal);
    return range < no_hit ? smooth_hit(range, T_sonar_shape_.orientation * normal, material_) : SurfaceHit{};
  }

 protected:
  /// @return the first range > 0 at which the ray meets the shape, with its normal there; infinity if it
  /// misses
  virtual double meet(const glm::dvec3& origin, const glm::dvec3& direction, glm::dvec3& normal) const = 0;

 private:
  render::Pose T_sonar_shape_;
  glm::dvec3 origin_;
  Material material_;
};

class Cylinder : public PlacedShape {
 public:
  Cylinder(const render::Pose& T_sonar_shape, double radius, double length, const Material& material)
      : PlacedShape(T_sonar_shape, material), radius_(radius), half_(length / 2) {}

 protected:
  double meet(const glm::dvec3& origin, const glm::dvec3& direction, glm::dvec3& normal) const override {
    double nearest = no_hit;
    const glm::dvec2 o(origin);
    const glm::dvec2 d(direction);
    const double a = glm::dot(d, d);
    const double along = -glm::dot(o, d) / a;
    const glm::dvec2 foot = o + along * d;
    const double half_chord = std::sqrt((radius_ * radius_ - glm::dot(foot, foot)) / a);
    for (const double t : {along - half_chord, along + half_chord}) {
      const glm::dvec3 p = origin + t * direction;
      if (t > 0 && t < nearest && std::abs(p.z) <= half_) {  // false without a chord: t is NaN
        nearest = t;
        normal = {p.x / radius_, p.y / radius_, 0};
      }
    }
    for (const double cap : {-half_, half_}) {
      const double t = (cap - origin.z) / direction.z;
      const glm::dvec2 p = o + t * d;
      if (t > 0 && t < nearest && glm::dot(p, p) <= radius_ * radius_) {
        nearest = t;
        normal = {0, 0, cap > 0 ? 1 : -1};
      }
    }
    return nearest;
  }

 private:
  double radius_, half_;
};

class Box : public PlacedShape {
 public:
  Box(const render::Pose& T_sonar_shape, const glm::dvec3& size, const Material& material)
      : PlacedShape(T_sonar_shape, material), half_(size / 2.0) {}

 protected:
  double meet(const glm::dvec3& origin, const glm::dvec3& direction, glm::dvec3& normal) const override {
    double nearest = no_hit;
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      const int last = (axis + 2) % 3;
      for (const double side : {-1.0, 1.0}) {
        const double t = (side * half_[axis] - origin[axis]) / direction[axis];
        const bool inside = std::abs(origin[next] + t * direction[next]) <= half_[next] &&
                            std::abs(origin[last] + t * direction[last]) <= half_[last];
        if (t > 0 && t < nearest && inside) {
          nearest = t;
          normal = glm::dvec3(0);
          normal[axis] = side;
        }
      }
    }
    return nearest;
  }

 private:
  glm::dvec3 half_;
};

class Group : public Surface {
 public:
  explicit Group(std::vector<std::unique_ptr<Surface>> members) : members_(std::move(members)) {}

  SurfaceHit nearest(const glm::dvec3& direction) const override {
    SurfaceHit nearest;
    for (const auto& member : members_) {
      const SurfaceHit hit = member->nearest(direction);
      nearest = hit.range_m < nearest.range_m ? hit : nearest;
    }
    return nearest;
  }

 private:
  std::vector<std::unique_ptr<Surface>> members_;
};

}  // namespace

std::unique_ptr<Surface> make_plane(const glm::dvec3& point, const glm::dvec3& normal,
                                    const Material& material) {
  return std::make_unique<Plane>(point, normal, material);
}

std::unique_ptr<Surface> make_thin_wall(const glm::dvec3& centre, const glm::dvec3& half_side_u,
                                        const glm::dvec3& half_side_v, const Material& material) {
  return std::make_unique<ThinWall>(centre, half_side_u, half_side_v, material);
}

std::unique_ptr<Surface> make_sphere(const glm::dvec3& centre, double radius, const Material& material) {
  return std::make_unique<Sphere>(centre, radius, material);
}

std::unique_ptr<Surface> make_cylinder(const render::Pose& T_sonar_shape, double radius, double length,
                                       const Material& material) {
  return std::make_unique<Cylinder>(T_sonar_shape, radius, length, material);
}

std::unique_ptr<Surface> make_box(const render::Pose& T_sonar_shape, const glm::dvec3& size,
                                  const Material& material) {
  return std::make_unique<Box>(T_sonar_shape, size, material);
}

std::unique_ptr<Surface> make_group(std::vector<std::unique_ptr<Surface>> members) {
  return std::make_unique<Group>(std::move(members));
}

}  // namespace sonard::oracle
