// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/bounces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <glm/geometric.hpp>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/random.hpp"

namespace sonard::render {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double widest_cell_rad = 0.033;  // 1.9 degrees
constexpr double latest_m = 3.0;           // behind the straight echo: later echoes get no wider
constexpr int least_paths = 256;           // for a narrow fan, which gets smaller cells
constexpr double divided_from = 0.6;       // share of power sent on above which a cell gets 16 paths
// Limit of the response, the response of a white wall: rays are too few to sample glints of smooth surfaces.
constexpr double strongest = std::numbers::inv_pi;

/// The cells in which paths begin: a grid over the fan, in the sonar frame.
struct Grid {
  double port_rad, width_rad, lowest_rad, height_rad;  ///< width and height of a cell
  int columns, rows;
  double cell_rad() const { return std::max(width_rad, height_rad); }

  explicit Grid(const Aperture& aperture) {
    const std::vector<double>& edges = aperture.beam_edges_rad;
    const double wide_rad = edges.front() - edges.back();
    const double high_rad = 2 * aperture.elevation_limit_rad();
    const double cell = std::min(widest_cell_rad, std::sqrt(wide_rad * high_rad / least_paths));
    columns = std::max(1, static_cast<int>(std::lround(wide_rad / cell)));
    rows = std::max(1, static_cast<int>(std::lround(high_rad / cell)));
    port_rad = edges.front();
    lowest_rad = -aperture.elevation_limit_rad();
    width_rad = wide_rad / columns;
    height_rad = high_rad / rows;
  }

  FanCell cell(int column, int row) const {
    return {0, port_rad - (column + 0.5) * width_rad, lowest_rad + (row + 0.5) * height_rad, width_rad,
            height_rad};
  }
};

/// How a surface distributes the incident power; the rest is absorbed.
struct Shares {
  double mirror, facets, lambert;

  Shares(const PathScene& scene, const PathHit& hit, double wavelength_m) {
    const Mirror& law = scene.mirror(hit);
    const double reflected = law.pressure_reflection * law.pressure_reflection;
    mirror = law.gain(hit.cosine, wavelength_m);
    facets = reflected - mirror;
    lambert = std::min(pi * scene.lambert_mu(hit), 1 - reflected);
  }
  double sum() const { return mirror + facets + lambert; }
};

/// Integral from -1 to x of a triangle of area 1 between -1 and 1.
double triangle_below(double x) {
  const double at = std::clamp(x, -1.0, 1.0);
  return at < 0 ? 0.5 * (1 + at) * (1 + at) : 1 - 0.5 * (1 - at) * (1 - at);
}

/// Two unit vectors across a third, which turn with the sonar: so the paths are the same if world and sonar
/// are turned together.
void make_axes(const glm::dquat& R_world_sonar, const glm::dvec3& normal, glm::dvec3& a, glm::dvec3& b) {
  const glm::dvec3 up = R_world_sonar * glm::dvec3(0, 0, 1);
  const glm::dvec3 other = std::abs(glm::dot(normal, up)) < 0.9 ? up : R_world_sonar * glm::dvec3(1, 0, 0);
  a = glm::normalize(glm::cross(normal, other));
  b = glm::cross(normal, a);
}

class Path {
 public:
  struct Ping {
    const PathScene& scene;
    const PathFan& fan;
    glm::dquat R_world_sonar, R_sonar_world;
    PathLimits limits;
    int most_bounces;
    double loss;      ///< factor of the power at each bounce
    double cell_rad;  ///< width of a cell of the grid
  };

  Path(const Ping& ping, RandomKey numbers, const FanCell& cell, std::vector<BeamPatch>& out)
      : ping_(ping), numbers_(numbers), cell_(cell), out_(out) {}

  /// @param first first hit in the cell's direction
  void follow(const glm::dvec3& direction, const PathHit& first) {
    direction_ = direction;
    hit_ = first;
    length_m_ = first.distance_m;
    const double elevation_rad = cell_.elevation_rad;
    power_ = cell_.solid_angle() * std::sqrt(ping_.fan.aperture().elevation_weight(elevation_rad));
    for (int bounce = 1; bounce < ping_.most_bounces; ++bounce) {
      bool mirrored = false;
      if (!leave(mirrored)) {
        return;
      }
      power_ *= ping_.loss;
      const PathHit from = hit_;
      if (!ping_.scene.trace(from.position_m, from.normal, direction_,
                             2 * ping_.limits.max_range_m - length_m_, hit_)) {
        return;
      }
      length_m_ += hit_.distance_m;
      // GhostPaths adds the echo of a rough surface in a mirror.
      come_back(mirrored && bounce == 1);
    }
  }

 private:
  double number() { return uniform_number(numbers_, next_number_++); }

  /// Chooses a random new direction. @return false if the path ends; the probability is the absorbed share.
  bool leave(bool& mirrored) {
    const Shares shares(ping_.scene, hit_, ping_.limits.wavelength_m);
    const double chance = number();
    const double x = number(), y = number();
    glm::dvec3 a, b;
    make_axes(ping_.R_world_sonar, hit_.normal, a, b);
    if (chance < shares.lambert) {
      const double sine = std::sqrt(x);
      direction_ =
          sine * std::cos(2 * pi * y) * a + sine * std::sin(2 * pi * y) * b + std::sqrt(1 - x) * hit_.normal;
      return true;
    }
    if (chance >= shares.sum()) {
      return false;
    }
    mirrored = chance < shares.lambert + shares.mirror;
    glm::dvec3 facet = hit_.normal;
    if (!mirrored) {  // slopes are normal (docs/physics.md 2.4)
      const double slope = ping_.scene.rms_slope(hit_) * std::sqrt(-2 * std::log(1 - x));
      facet =
          glm::normalize(hit_.normal + slope * std::cos(2 * pi * y) * a + slope * std::sin(2 * pi * y) * b);
    }
    direction_ = reflected(direction_, facet);
    return glm::dot(direction_, hit_.normal) > 0;
  }

  /// Adds the echo that goes straight from the current hit to the sonar.
  void come_back(bool ghost) {
    const double straight_m = glm::length(hit_.position_m);
    const double range_m = 0.5 * (length_m_ + straight_m);
    if (!(range_m < ping_.limits.max_range_m)) {
      return;
    }
    const glm::dvec3 back = hit_.position_m / -straight_m;
    const glm::dvec3 p = ping_.R_sonar_world * -back;
    const double cosine = glm::dot(hit_.normal, back);
    if (!(cosine > 0) || !ping_.fan.contains(p)) {
      return;
    }
    const double response = sent_back(back, cosine, ghost);
    if (!(response > 0) || !ping_.scene.sees_sonar(hit_)) {
      return;
    }
    const double weight = ping_.fan.aperture().elevation_weight(std::asin(std::clamp(p.z, -1.0, 1.0)));
    const double longer = range_m / straight_m;  // each line later gets the loss of its own range
    add(range_m, straight_m, std::atan2(p.y, p.x), power_ * response * std::sqrt(weight) * longer * longer);
  }

  /// Power per steradian towards the sonar, re the incident power.
  double sent_back(const glm::dvec3& back, double cosine, bool ghost) const {
    const Shares shares(ping_.scene, hit_, ping_.limits.wavelength_m);
    const glm::dvec3 facet = glm::normalize(back - direction_);
    const double of_facet = glm::dot(facet, hit_.normal);
    double response = ghost ? 0.0 : shares.lambert / pi * cosine;
    if (of_facet > 0 && shares.facets > 0) {
      const double m = ping_.scene.rms_slope(hit_);
      const double tangent2 = 1 / (of_facet * of_facet) - 1;
      const double density = std::exp(-tangent2 / (2 * m * m)) / (2 * pi * m * m);
      response += shares.facets * density / (4 * glm::dot(facet, back) * of_facet * of_facet * of_facet);
    }
    return std::min(response, strongest);
  }

  /// A path represents all paths that begin in its cell, and these diverge with their length. Their echo is
  /// therefore spread over some length, starting at `range_m`, and over some beams.
  void add(double range_m, double straight_m, double bearing_rad, double echo) {
    const double later_m = range_m - straight_m;
    const double length_m = std::max(range_m * ping_.cell_rad, 0.5 * later_m);
    const double half_rad = ping_.cell_rad * (1 + std::min(later_m, latest_m));
    EchoPatch patch;  // rises over its first half and falls over its second
    patch.range_a_m = static_cast<float>(range_m + 0.25 * length_m);
    patch.range_b_m = static_cast<float>(range_m + 0.75 * length_m);
    patch.smear_a_m = patch.smear_b_m = static_cast<float>(0.5 * length_m);
    const std::vector<double>& edges = ping_.fan.aperture().beam_edges_rad;
    const auto beam_at = [&](double azimuth_rad) {
      return *ping_.fan.beam_of(std::clamp(azimuth_rad, edges.back(), edges.front()));
    };
    const auto share_to_port_of = [&](std::size_t edge) {
      return triangle_below((edges[edge] - bearing_rad) / half_rad);
    };
    for (int beam = beam_at(bearing_rad + half_rad); beam <= beam_at(bearing_rad - half_rad); ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      patch.echo = static_cast<float>(echo * (share_to_port_of(b) - share_to_port_of(b + 1)));
      if (patch.echo > 0) {
        out_.push_back({beam, patch});
      }
    }
  }

  const Ping& ping_;
  RandomKey numbers_;
  std::uint64_t next_number_ = 2;  // numbers 0 and 1 set its place in the cell
  FanCell cell_;
  std::vector<BeamPatch>& out_;
  glm::dvec3 direction_{0.0};
  PathHit hit_;
  double length_m_ = 0.0;
  double power_ = 0.0;  ///< of the cell, less the loss at each bounce; absorption ends paths (leave())
};

/// The paths of 4 x 4 neighbouring cells, whose first legs are traced together.
class Group {
 public:
  Group(const Path::Ping& ping, std::vector<BeamPatch>& out) : ping_(ping), out_(out) {}

  void add(const FanCell& cell, RandomKey numbers) {
    const auto k = static_cast<std::size_t>(count_++);
    numbers_[k] = numbers;
    cells_[k] = cell;
    // A random place in the cell: a regular grid would be visible in the image.
    cells_[k].azimuth_rad += cell.width_rad * (uniform_number(numbers, 0) - 0.5);
    cells_[k].elevation_rad += cell.height_rad * (uniform_number(numbers, 1) - 0.5);
    directions_[k] = ping_.R_world_sonar * cells_[k].direction();
  }

  void follow(bool may_divide) {
    std::fill(directions_.begin() + count_, directions_.end(), directions_.front());
    std::array<PathHit, packet_size> first;
    ping_.scene.trace_from_sonar(directions_, ping_.limits.max_range_m, first);
    for (int i = 0; i < count_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (!(first[k].distance_m > 0)) {
        continue;
      }
      const Shares shares(ping_.scene, first[k], ping_.limits.wavelength_m);
      if (may_divide && shares.sum() > divided_from) {
        follow_parts(cells_[k], numbers_[k]);
      } else {
        Path(ping_, numbers_[k], cells_[k], out_).follow(directions_[k], first[k]);
      }
    }
  }

 private:
  void follow_parts(const FanCell& cell, RandomKey numbers) {
    Group parts(ping_, out_);
    for (int i = 0; i < packet_size; ++i) {
      parts.add(cell.part(i % packet_side, i / packet_side, packet_side, packet_side),
                {numbers.value + static_cast<std::uint64_t>(i + 1) * 0x9E3779B97F4A7C15U});
    }
    parts.follow(false);
  }

  const Path::Ping& ping_;
  std::vector<BeamPatch>& out_;
  int count_ = 0;
  std::array<FanCell, packet_size> cells_;
  std::array<RandomKey, packet_size> numbers_;
  PathScene::Directions directions_;
};

}  // namespace

Bounces::Bounces(const World& world, WorkerPool& workers) : workers_(workers) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    for (std::size_t p = 0; p < world.bodies[b].parts.size(); ++p) {
      const BodyPart& part = world.bodies[b].parts[p];
      const AcousticMaterial& material = part.material;
      if (material.pressure_reflection * material.pressure_reflection + pi * material.lambert_mu >
          least_sent_on) {
        parts_.push_back({b, p, MirrorSurvey::ball_around(*part.mesh)});
      }
    }
  }
}

bool Bounces::any_in_range(const World& world, const glm::dvec3& sonar_position_m, double max_range_m) const {
  return std::ranges::any_of(parts_, [&](const Part& part) {
    const Body& body = world.bodies[part.body];
    const glm::dvec3 centre_m = (body.T_world_body * body.parts[part.part].T_body_part) * part.ball.centre_m;
    return glm::length(centre_m - sonar_position_m) - part.ball.radius_m < max_range_m;
  });
}

const std::vector<std::vector<BeamPatch>>& Bounces::follow(const PathScene& scene, const PathFan& fan,
                                                           const Pose& T_world_sonar,
                                                           const PathLimits& limits,
                                                           const MultipathSettings& settings) {
  const Grid grid(fan.aperture());
  const Path::Ping ping{scene,
                        fan,
                        T_world_sonar.orientation,
                        glm::conjugate(T_world_sonar.orientation),
                        limits,
                        settings.most_bounces,
                        decibels_to_power(-settings.bounce_loss_db),
                        grid.cell_rad()};
  const int groups_across = (grid.columns + packet_side - 1) / packet_side;
  const int groups_up = (grid.rows + packet_side - 1) / packet_side;
  results_.resize(static_cast<std::size_t>(groups_across * groups_up));
  workers_.run(groups_across * groups_up, [&](int group) {
    std::vector<BeamPatch>& out = results_[static_cast<std::size_t>(group)];
    out.clear();
    Group paths(ping, out);
    for (int i = 0; i < packet_size; ++i) {
      const int column = group / groups_up * packet_side + i % packet_side;
      const int row = group % groups_up * packet_side + i / packet_side;
      if (column < grid.columns && row < grid.rows) {
        paths.add(grid.cell(column, row),
                  make_random_key(0, 0, RandomField::bounces,
                                  static_cast<std::uint64_t>(row * grid.columns + column)));
      }
    }
    paths.follow(true);
  });
  return results_;
}

}  // namespace sonard::render
