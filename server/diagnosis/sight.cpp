// SPDX-License-Identifier: Apache-2.0
#include "server/diagnosis/sight.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "server/diagnosis/triangles.hpp"

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

bool contains(const BodyBox& box, const glm::dvec3& p, double margin_m = 0.0) {
  return glm::all(glm::lessThanEqual(box.min_m - margin_m, p)) &&
         glm::all(glm::lessThanEqual(p, box.max_m + margin_m));
}

double distance_m(const BodyBox& box, const glm::dvec3& p) {
  return glm::length(p - glm::clamp(p, box.min_m, box.max_m));
}

BodyBox box_of(const render::Body& body) {
  BodyBox box{glm::dvec3(std::numeric_limits<double>::infinity()),
              glm::dvec3(-std::numeric_limits<double>::infinity())};
  for (const render::BodyPart& part : body.parts) {
    for (const glm::vec3& position : part.mesh->positions) {
      const glm::dvec3 p = part.T_body_part * glm::dvec3(position);
      box.min_m = glm::min(box.min_m, p);
      box.max_m = glm::max(box.max_m, p);
    }
  }
  return box;
}

glm::dvec3 nearest_on_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double share = length2 > 0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return a + share * along;
}

/// Nearest point of a triangle: the foot of the perpendicular if it is inside, else a point on an edge.
glm::dvec3 nearest_on_triangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double area2 = glm::dot(normal, normal);
  if (area2 > 0) {
    const glm::dvec3 foot = p - glm::dot(p - t[0], normal) / area2 * normal;
    bool within = true;
    for (std::size_t i = 0; i < 3; ++i) {
      within = within && glm::dot(glm::cross(t[(i + 1) % 3] - t[i], foot - t[i]), normal) >= 0;
    }
    if (within) {
      return foot;
    }
  }
  glm::dvec3 nearest = nearest_on_segment(p, t[0], t[1]);
  for (const glm::dvec3& other : {nearest_on_segment(p, t[1], t[2]), nearest_on_segment(p, t[2], t[0])}) {
    if (glm::length(p - other) < glm::length(p - nearest)) {
      nearest = other;
    }
  }
  return nearest;
}

/// Intersections of a ray with a body.
struct Crossings {
  int count = 0;
  double nearest = std::numeric_limits<double>::infinity();  ///< in lengths of the direction
  bool from_behind = false;                                  ///< the nearest triangle shows its back
};

/// Counts the intersection of a ray with a triangle (Moeller and Trumbore 1997).
void cross(const glm::dvec3& from, const glm::dvec3& direction, const std::array<glm::dvec3, 3>& t,
           Crossings& crossings) {
  const glm::dvec3 a = t[1] - t[0];
  const glm::dvec3 b = t[2] - t[0];
  const glm::dvec3 p = glm::cross(direction, b);
  const double determinant = glm::dot(a, p);
  if (determinant == 0.0) {
    return;
  }
  const glm::dvec3 s = from - t[0];
  const double u = glm::dot(s, p) / determinant;
  const glm::dvec3 q = glm::cross(s, a);
  const double v = glm::dot(direction, q) / determinant;
  const double distance = glm::dot(b, q) / determinant;
  if (u < 0 || v < 0 || u + v > 1 || distance <= 0) {
    return;
  }
  ++crossings.count;
  if (distance < crossings.nearest) {
    crossings.nearest = distance;
    crossings.from_behind = determinant < 0;
  }
}

Crossings crossings_of(const render::Body& body, const glm::dvec3& from, const glm::dvec3& direction) {
  Crossings crossings;
  each_triangle(
      body, [&](const std::array<glm::dvec3, 3>& triangle) { cross(from, direction, triangle, crossings); });
  return crossings;
}

enum class Within { outside, solid, hollow };

/// A ray from inside a closed mesh crosses an odd number of triangles. Three rays must be odd, so that an
/// open mesh (a bed, a tank without a lid) does not count as closed. From inside, a room shows the front of
/// its triangles, a solid body the back.
Within where_in(const render::Body& body, const glm::dvec3& p_body) {
  int backs = 0;
  for (const glm::dvec3& direction : {glm::dvec3(0.137, 0.071, 0.988), glm::dvec3(-0.113, 0.989, 0.093),
                                      glm::dvec3(0.991, -0.127, -0.043)}) {
    const Crossings crossings = crossings_of(body, p_body, direction);
    if (crossings.count % 2 == 0) {
      return Within::outside;
    }
    backs += crossings.from_behind ? 1 : 0;
  }
  return backs >= 2 ? Within::solid : Within::hollow;
}

/// True if a ray meets a box.
bool meets(const BodyBox& box, const glm::dvec3& from, const glm::dvec3& direction) {
  double enters = 0.0;
  double leaves = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double to_min = box.min_m[axis] - from[axis];
    const double to_max = box.max_m[axis] - from[axis];
    if (direction[axis] == 0.0) {
      leaves = to_min <= 0 && to_max >= 0 ? leaves : -1.0;
      continue;
    }
    enters = std::max(enters, std::min(to_min / direction[axis], to_max / direction[axis]));
    leaves = std::min(leaves, std::max(to_min / direction[axis], to_max / direction[axis]));
  }
  return enters <= leaves;
}

/// The name of geographic coordinates that a position looks like; "" if it looks like none. UTM easting and
/// northing, in either order: 100 to 900 km, and 1000 to 10 000 km. ECEF: near the surface of the Earth.
std::string_view coordinates_of(const glm::dvec3& p) {
  const double less = std::min(p.x, p.y);
  const double more = std::max(p.x, p.y);
  if (less > 1e5 && less < 9e5 && more > 1e6 && more < 1e7 && std::abs(p.z) < 1.2e4) {
    return "UTM (easting, northing)";
  }
  const double from_centre_m = glm::length(p);
  return from_centre_m > 6.34e6 && from_centre_m < 6.39e6 ? "ECEF (from the centre of the Earth)" : "";
}

/// A body at its current pose, with the sonar's position.
struct Neighbour {
  const render::Body* body = nullptr;
  render::Pose T_world_body;
  BodyBox box;              ///< in the body's frame
  glm::dvec3 sonar_m{0.0};  ///< in the body's frame
  bool is_terrain = false;
};

class LookAround {
 public:
  LookAround(const render::World& world, const std::vector<BodyBox>& boxes,
             const std::vector<PosedBody>& moved, const Sight& sight)
      : world_(world), sight_(sight) {
    for (std::size_t i = 0; i < world.bodies.size(); ++i) {
      const render::Body& body = world.bodies[i];
      if ((body.name == sight.vehicle_model && sight.hides_vehicle) || boxes[i].min_m.x > boxes[i].max_m.x) {
        continue;
      }
      Neighbour neighbour{&body, body.T_world_body, boxes[i], {}};
      for (const PosedBody& posed : moved) {
        if (posed.name == body.name) {
          neighbour.T_world_body = posed.T_world_body;
        }
      }
      neighbour.sonar_m = render::inverse(neighbour.T_world_body) * sight.T_world_sonar.position_m;
      neighbour.is_terrain = std::ranges::any_of(
          world.terrains, [i](const render::TerrainParts& terrain) { return terrain.body == i; });
      neighbours_.push_back(neighbour);
    }
  }

  std::vector<Finding> findings() {
    note_surface();
    note_upside_down();
    note_inside();
    note_under_ground();
    const bool sees_surface = sight_.sees_surface.value_or(false);
    if (findings_.empty() && (!sees_surface || sight_.echo_over_floor < least_visible_echo)) {
      note_what_is_near(sees_surface);
    }
    return std::move(findings_);
  }

 private:
  void add(std::string code, std::string text) { findings_.push_back({std::move(code), std::move(text)}); }

  /// True if a place is within the sonar's range of the box of any body.
  bool is_in_the_world(const glm::dvec3& p) const {
    return std::ranges::any_of(neighbours_, [&](const Neighbour& neighbour) {
      const glm::dvec3 p_body = render::inverse(neighbour.T_world_body) * p;
      return contains(neighbour.box, p_body, sight_.range_m);
    });
  }

  const glm::dvec3& vehicle_m() const { return sight_.T_world_vehicle.position_m; }
  const glm::dvec3& sonar_m() const { return sight_.T_world_sonar.position_m; }
  double arm_m() const { return glm::length(sonar_m() - vehicle_m()); }
  bool has_long_arm() const { return arm_m() > longest_arm_m; }

  /// The position of the sonar if the vehicle were at `other_m`. Poses are of the vehicle: another unit or
  /// sign of theirs leaves the mount as it is.
  glm::dvec3 sonar_with_vehicle_at(const glm::dvec3& other_m) const {
    return other_m + (sonar_m() - vehicle_m());
  }
  /// The position of the sonar if z of the vehicle had the opposite sign.
  glm::dvec3 sonar_with_z_turned() const {
    return sonar_with_vehicle_at({vehicle_m().x, vehicle_m().y, -vehicle_m().z});
  }

  std::string mount_hint() const {
    return fmt::format("the mount places the sonar {:.4g} m from the vehicle: is mount.position_m in metres?",
                       arm_m());
  }

  /// The likely unit of positions if they are not in metres: "centimetres or millimetres" if either would put
  /// the sonar into the world; empty if neither would.
  std::string wrong_unit() const {
    std::string unit;
    const auto consider = [&](double per_m, const char* name) {
      if (glm::length(vehicle_m()) > per_m && !is_in_the_world(sonar_m()) &&
          is_in_the_world(sonar_with_vehicle_at(vehicle_m() / per_m))) {
        unit += (unit.empty() ? "" : " or ") + std::string(name);
      }
    };
    consider(100, "centimetres");
    consider(1000, "millimetres");
    return unit;
  }

  void note_surface() {
    if (!world_.water_surface_z_m || sonar_m().z <= *world_.water_surface_z_m) {
      return;
    }
    const double above_m = sonar_m().z - *world_.water_surface_z_m;
    const std::string unit = wrong_unit();
    const glm::dvec3 turned_m = sonar_with_z_turned();
    const bool turned = is_in_the_world(turned_m) && turned_m.z <= *world_.water_surface_z_m;
    const bool by_mount = has_long_arm() && vehicle_m().z <= *world_.water_surface_z_m;
    const std::string other = coordinates_hint();
    add("above_surface",
        fmt::format("The sonar is {:.1f} m above the water surface, in the air{}.{}", above_m,
                    by_mount         ? fmt::format(" ({})", mount_hint())
                    : !other.empty() ? ""
                    : !unit.empty()  ? fmt::format(" (are positions in {}?)", unit)
                    : turned         ? " (is z down?)"
                                     : "",
                    by_mount ? "" : other));
  }

  /// A hint if either the poses or the bodies of the world have geographic coordinates; else "".
  std::string coordinates_hint() const {
    std::string_view of_world;
    for (const Neighbour& neighbour : neighbours_) {
      if (neighbour.body->name != sight_.vehicle_model && of_world.empty()) {
        of_world =
            coordinates_of(neighbour.T_world_body * (0.5 * (neighbour.box.min_m + neighbour.box.max_m)));
      }
    }
    const std::string_view of_pose = coordinates_of(vehicle_m());
    if (of_pose.empty() == of_world.empty()) {
      return "";
    }
    return fmt::format(
        " {} looks like {}, but the {} not: subtract the position of the world's origin from "
        "the poses, or use the same coordinates for both.",
        of_world.empty() ? "The position" : "The world", of_world.empty() ? of_pose : of_world,
        of_world.empty() ? "world does" : "position does");
  }

  /// A hint if the sonar is above all bodies and, with the opposite sign of z, would be lower but not under
  /// them; else "". For worlds without a water surface, with bodies in range.
  std::string z_hint() const {
    double lowest_m = std::numeric_limits<double>::infinity();
    double highest_m = -lowest_m;
    for (const Neighbour& neighbour : neighbours_) {
      if (neighbour.body->name == sight_.vehicle_model) {
        continue;
      }
      const auto [min_m, max_m] = neighbour.box;
      const double middle_m = (neighbour.T_world_body * (0.5 * (min_m + max_m))).z;
      const glm::dvec3 up = glm::inverse(neighbour.T_world_body.orientation) * glm::dvec3(0.0, 0.0, 1.0);
      const double half_height_m = glm::dot(glm::abs(up), 0.5 * (max_m - min_m));
      lowest_m = std::min(lowest_m, middle_m - half_height_m);
      highest_m = std::max(highest_m, middle_m + half_height_m);
    }
    const glm::dvec3 turned_m = sonar_with_z_turned();
    const bool fits = sonar_m().z > highest_m && turned_m.z < sonar_m().z && turned_m.z > lowest_m &&
                      is_in_the_world(turned_m);
    return fits ? " With the opposite sign of z, the sonar would be inside the world (is z down?)." : "";
  }

  /// Detects a quaternion with w first that was read as x, y, z, w: a level vehicle then leans by 180 degrees
  /// minus its heading. (A vehicle that heads due west looks level and is not detected.) Also detects a
  /// vehicle frame with z down.
  void note_upside_down() {
    const glm::dquat& q = sight_.T_world_vehicle.orientation;
    const auto up_of = [](const glm::dquat& turn) { return (turn * glm::dvec3(0, 0, 1)).z; };
    const bool overturned = up_of(q) < -0.98;
    if (up_of(q) < 0.7 && up_of(glm::dquat(q.x, q.y, q.z, q.w)) > 0.98) {
      add("quaternion_w_first",
          fmt::format(
              "The vehicle lies on its side or upside down (is its quaternion sent with w first? With "
              "w first, it would be level. A message names x, y, z and w; a trajectory file has w "
              "last{}).",
              overturned ? ". Or is z of its frame down? It must be up" : ""));
    } else if (overturned) {
      add("upside_down",
          "The vehicle is upside down (is z of its frame down? x must be forward, y left and z up).");
    }
  }

  void note_inside() {
    for (const Neighbour& neighbour : neighbours_) {
      if (!contains(neighbour.box, neighbour.sonar_m)) {
        continue;
      }
      const render::Body& body = *neighbour.body;
      const Within within = where_in(body, neighbour.sonar_m);
      const bool is_vehicle = body.name == sight_.vehicle_model;
      const glm::dvec3 size = neighbour.box.max_m - neighbour.box.min_m;
      // A sonar may be inside a tank or a harbour, and see it.
      const bool holds_a_sonar = within == Within::hollow && sight_.sees_surface.value_or(true) &&
                                 !is_vehicle && glm::length(size) > 5.0;
      if (within != Within::outside && !holds_a_sonar) {
        add(is_vehicle ? "inside_vehicle" : "inside_body",
            fmt::format("The sonar is inside the body '{}'{}.", body.name,
                        is_vehicle ? ", its own vehicle (to hide it, set hides_vehicle: true)" : ""));
      }
    }
  }

  Crossings straight(const Neighbour& neighbour, double up) const {
    const glm::dvec3 direction = glm::inverse(neighbour.T_world_body.orientation) * glm::dvec3(0.0, 0.0, up);
    return meets(neighbour.box, neighbour.sonar_m, direction)
               ? crossings_of(*neighbour.body, neighbour.sonar_m, direction)
               : Crossings{};
  }

  /// True for a possible bed: terrain, or a sheet or slab of more than ten metres both ways.
  static bool may_be_ground(const Neighbour& neighbour) {
    const glm::dvec3 size = neighbour.box.max_m - neighbour.box.min_m;
    std::array<double, 3> sides{size.x, size.y, size.z};
    std::ranges::sort(sides);
    return neighbour.is_terrain || (sides[1] > 10.0 && sides[0] < 0.5 * sides[1]);
  }

  /// Reports a sonar below the lowest body, if that body is wide. If its echo is visible, the body may be ice
  /// or a ship, unless the echo comes from the back of a surface.
  void note_under_ground() {
    const Neighbour* ground = nullptr;
    Crossings overhead;
    for (const Neighbour& neighbour : neighbours_) {
      if (!may_be_ground(neighbour) || neighbour.body->name == sight_.vehicle_model) {
        continue;
      }
      const Crossings up = straight(neighbour, 1.0);
      if (up.nearest < overhead.nearest) {
        ground = &neighbour;
        overhead = up;
      }
    }
    const bool turns_its_back = overhead.from_behind || (ground != nullptr && ground->is_terrain);
    const bool receives_it =
        sight_.sees_surface.value_or(true) && sight_.echo_over_floor >= least_visible_echo && !turns_its_back;
    if (ground == nullptr || !findings_.empty() || receives_it ||
        std::ranges::any_of(neighbours_,
                            [&](const Neighbour& other) { return straight(other, -1.0).count > 0; })) {
      return;
    }
    const bool by_mount = has_long_arm() && vehicle_m().z > sonar_m().z + overhead.nearest;
    add("under_ground",
        fmt::format("The sonar is {:.4g} m below the body '{}', and nothing is below the sonar: is it under "
                    "the bed ({})?",
                    overhead.nearest, ground->body->name,
                    by_mount ? mount_hint() : "is z of the pose correct"));
  }

  void note_what_is_near(bool sees_surface) {
    const Neighbour* nearest = nullptr;
    glm::dvec3 point_world{0.0};
    double least_m = std::numeric_limits<double>::infinity();
    std::ranges::sort(neighbours_, {}, [](const Neighbour& neighbour) {
      return distance_m(neighbour.box, neighbour.sonar_m);
    });
    for (const Neighbour& neighbour : neighbours_) {
      if (distance_m(neighbour.box, neighbour.sonar_m) > least_m) {
        break;
      }
      each_triangle(*neighbour.body, [&](const std::array<glm::dvec3, 3>& triangle) {
        const glm::dvec3 point = nearest_on_triangle(neighbour.sonar_m, triangle);
        const double away_m = glm::length(point - neighbour.sonar_m);
        if (away_m < least_m) {
          least_m = away_m;
          nearest = &neighbour;
          point_world = neighbour.T_world_body * point;
        }
      });
    }
    if (nearest == nullptr) {
      if (world_.triangle_count() > 0) {  // else it is open water by configuration
        add("empty_world",
            "The world has no body that reflects sound, because the vehicle's own model is hidden.");
      }
    } else if (!sees_surface && least_m > sight_.range_m) {
      note_far(*nearest, least_m);
    } else if (sees_surface) {
      const double below_db = -10.0 * std::log10(std::max(sight_.echo_over_floor, 1e-10));
      add("too_faint",
          fmt::format("No echo stands out: the strongest one is {:.0f} dB{} below the noise and the smallest "
                      "step of the samples. {}{} Turn the sonar towards it, or move closer.",
                      below_db, below_db < 100.0 ? "" : " or more",
                      where_is("The", *nearest, least_m, point_world), z_hint()));
    } else if (sight_.sees_surface) {
      add("nothing_in_fan",
          "Nothing is in the fan; " + where_is("the", *nearest, least_m, point_world) + z_hint());
    }
  }

  void note_far(const Neighbour& nearest, double away_m) {
    const glm::dvec3& p = vehicle_m();
    const std::string text =
        fmt::format("Nothing is within {:.4g} m; the nearest body, '{}', is {:.4g} m away", sight_.range_m,
                    nearest.body->name, away_m);
    if (has_long_arm() && is_in_the_world(p)) {
      add("nothing_near", fmt::format("{}. The vehicle is inside the world, but {}", text, mount_hint()));
    } else if (const std::string other = coordinates_hint(); !other.empty()) {
      add("geographic_coordinates", text + "." + other);
    } else if (const std::string unit = wrong_unit(); !unit.empty()) {
      add("wrong_unit", fmt::format("{}. In {}, the position would be inside the world: are positions in {}?",
                                    text, unit, unit));
    } else if (is_in_the_world(sonar_with_z_turned())) {
      add("z_down", text + ". With the opposite sign of z, it would be inside the world (is z down?).");
    } else {
      add("nothing_near", text + ".");
    }
  }

  std::string where_is(std::string_view article, const Neighbour& nearest, double away_m,
                       const glm::dvec3& point_world) const {
    const glm::dvec3 p = render::inverse(sight_.T_world_sonar) * point_world;
    const double bearing_rad = std::atan2(-p.y, p.x);  // positive to starboard
    const double elevation_rad = std::atan2(p.z, std::hypot(p.x, p.y));
    return fmt::format(
        "{} nearest body, '{}', is {:.4g} m away, {:.0f} degrees to {} and {:.0f} degrees {} the axis of the "
        "sonar.",
        article, nearest.body->name, away_m, std::abs(bearing_rad) / degree,
        bearing_rad < 0 ? "port" : "starboard", std::abs(elevation_rad) / degree,
        elevation_rad < 0 ? "below" : "above");
  }

  const render::World& world_;
  const Sight& sight_;
  std::vector<Neighbour> neighbours_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<BodyBox> boxes_of(const render::World& world) {
  std::vector<BodyBox> boxes;
  for (const render::Body& body : world.bodies) {
    boxes.push_back(box_of(body));
  }
  return boxes;
}

std::vector<Finding> look_around(const render::World& world, const std::vector<BodyBox>& boxes,
                                 const std::vector<PosedBody>& moved, const Sight& sight) {
  return LookAround(world, boxes, moved, sight).findings();
}

}  // namespace sonard::server
