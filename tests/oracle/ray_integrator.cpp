// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/ray_integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <glm/geometric.hpp>

#include "tests/oracle/beam_threads.hpp"
#include "tests/oracle/neumaier.hpp"

namespace sonard::oracle {

namespace {

/// One ray and its hit.
struct Probe {
  double psi, theta;
  glm::dvec3 direction;
  SurfaceHit hit;
};

/// Corners: 0 (psi, theta) low low, 1 high low, 2 low high, 3 high high.
using Corners = std::array<Probe, 4>;

/// Distribution of the ranges of a cell on a plane: the convolution of two boxes (docs/physics.md 2.3).
class Trapezoid {
 public:
  Trapezoid(double centre, double a, double b)
      : centre_(centre), wide_(std::max(a, b)), narrow_(std::min(a, b)) {}

  double first() const { return centre_ - (wide_ + narrow_) / 2; }
  double last() const { return centre_ + (wide_ + narrow_) / 2; }

  /// Share of the cell with a range below `edge`.
  double below(double edge) const {
    const double half = (wide_ + narrow_) / 2;
    const double x = edge - centre_;
    if (x <= -half || x >= half) {
      return x >= half ? 1.0 : 0.0;
    }
    const double core = (wide_ - narrow_) / 2;
    if (x < -core) {
      return (x + half) * (x + half) / (2 * wide_ * narrow_);
    }
    if (x > core) {
      return 1 - (half - x) * (half - x) / (2 * wide_ * narrow_);
    }
    return 0.5 + x / wide_;
  }

 private:
  double centre_, wide_, narrow_;
};

/// One beam on one grid.
class BeamGrid {
 public:
  BeamGrid(const Surface& surface, const EchoLaw& law, const RayOptions& options)
      : surface_(surface),
        law_(law),
        options_(options),
        echo_(static_cast<std::size_t>(law.lines())),
        weight_(law.is_mean() ? echo_.size() : 0) {}

  void integrate(double psi_low, double psi_high, int columns, int rows) {
    const double limit = law_.elevation_limit_rad();
    const auto psi = [&](int i) { return psi_low + (psi_high - psi_low) * i / columns; };
    const auto theta = [&](int j) { return limit * (2.0 * j / rows - 1); };
    for (int i = 0; i < columns; ++i) {
      Probe low = probe(psi(i), theta(0));
      Probe high = probe(psi(i + 1), theta(0));
      for (int j = 0; j < rows; ++j) {
        const Probe next_low = probe(psi(i), theta(j + 1));
        const Probe next_high = probe(psi(i + 1), theta(j + 1));
        add_cell({low, high, next_low, next_high}, 0);
        low = next_low;
        high = next_high;
      }
    }
  }

  std::vector<double> values() const {
    std::vector<double> values;
    for (std::size_t k = 0; k < echo_.size(); ++k) {
      const double weight = weight_.empty() ? 1.0 : weight_[k].value();
      values.push_back(weight > 0 ? echo_[k].value() / weight : 0.0);
    }
    return values;
  }
  std::uint64_t rays() const { return rays_; }

 private:
  Probe probe(double psi, double theta) {
    ++rays_;
    Probe result{psi, theta, {}, {}};
    result.direction = {std::cos(theta) * std::cos(psi), std::cos(theta) * std::sin(psi), std::sin(theta)};
    result.hit = surface_.nearest(result.direction);
    return result;
  }

  void add_cell(const Corners& corners, int depth) {
    const double psi = (corners[0].psi + corners[3].psi) / 2;
    const double theta = (corners[0].theta + corners[3].theta) / 2;
    const Probe centre = probe(psi, theta);
    if (depth == options_.refinements || is_even(centre, corners)) {
      add(centre, corners);
      return;
    }
    const Probe south = probe(psi, corners[0].theta);
    const Probe north = probe(psi, corners[3].theta);
    const Probe west = probe(corners[0].psi, theta);
    const Probe east = probe(corners[3].psi, theta);
    add_cell({corners[0], south, west, centre}, depth + 1);
    add_cell({south, corners[1], centre, east}, depth + 1);
    add_cell({west, centre, corners[2], north}, depth + 1);
    add_cell({centre, east, north, corners[3]}, depth + 1);
  }

  /// Whether the plane at the centre predicts the hits of the corners.
  bool is_even(const Probe& centre, const Corners& corners) const {
    const double distance = centre.hit.range_m * glm::dot(centre.hit.normal, centre.direction);
    const double cosine = std::abs(glm::dot(centre.hit.shading_normal, centre.direction));
    return std::all_of(corners.begin(), corners.end(), [&](const Probe& corner) {
      if (!corner.hit.is_hit() || !centre.hit.is_hit()) {
        return corner.hit.is_hit() == centre.hit.is_hit();
      }
      const double foretold = distance / glm::dot(centre.hit.normal, corner.direction);
      const double corner_cosine = std::abs(glm::dot(corner.hit.shading_normal, corner.direction));
      const double turned = std::abs(glm::dot(centre.hit.shading_normal, corner.direction));
      return std::abs(foretold - corner.hit.range_m) <= options_.range_tolerance * law_.step_m() &&
             std::abs(turned - corner_cosine) <= options_.cosine_tolerance * std::max(cosine, 0.1);
    });
  }

  /// Adds the cell as a part of the plane at its centre.
  void add(const Probe& centre, const Corners& corners) {
    if (!centre.hit.is_hit()) {
      return;
    }
    const double r = centre.hit.range_m;
    const double width = corners[3].psi - corners[0].psi;
    const double height = corners[3].theta - corners[0].theta;
    const double solid_angle = width * (std::sin(corners[3].theta) - std::sin(corners[0].theta));
    const double cosine = glm::dot(centre.hit.shading_normal, centre.direction);
    const double echo = solid_angle * law_.echo(centre.hit.material, cosine, r, centre.direction.z);
    const double weight = solid_angle * law_.pattern(centre.direction.z);
    // The derivatives of r = D / (n.d) follow from the direction's.
    const glm::dvec3 d_psi(-centre.direction.y, centre.direction.x, 0);
    const glm::dvec3 d_theta(-std::sin(centre.theta) * std::cos(centre.psi),
                             -std::sin(centre.theta) * std::sin(centre.psi), std::cos(centre.theta));
    const double facing = glm::dot(centre.hit.normal, centre.direction);
    const double a = std::abs(r * glm::dot(centre.hit.normal, d_psi) / facing) * width;
    const double b = std::abs(r * glm::dot(centre.hit.normal, d_theta) / facing) * height;
    const double widest = 2 * law_.max_range_m();  // limit for edge-on planes, which do not describe the cell
    if (!options_.footprint || !(a + b > 0)) {
      spread(Trapezoid(r, 0, 0), echo, weight);
    } else {
      spread(Trapezoid(r, std::min(a, widest), std::min(b, widest)), echo, weight);
    }
  }

  void spread(const Trapezoid& shape, double echo, double weight) {
    const double step = law_.step_m();
    const double first = std::max(0.0, std::floor(shape.first() / step));
    const double last = std::min(law_.lines() - 1.0, std::floor(shape.last() / step));
    if (!(first <= last)) {
      return;  // beyond the last line
    }
    if (shape.first() == shape.last()) {
      add_share(static_cast<std::size_t>(first), 1.0, echo, weight);
      return;
    }
    double below = shape.below(first * step);
    for (auto k = static_cast<std::size_t>(first); k <= static_cast<std::size_t>(last); ++k) {
      const double next = shape.below(static_cast<double>(k + 1) * step);
      add_share(k, next - below, echo, weight);
      below = next;
    }
  }

  void add_share(std::size_t k, double share, double echo, double weight) {
    echo_[k].add(share * echo);
    if (!weight_.empty()) {
      weight_[k].add(share * weight);
    }
  }

  const Surface& surface_;
  const EchoLaw& law_;
  const RayOptions& options_;
  std::vector<NeumaierSum> echo_, weight_;
  std::uint64_t rays_ = 0;
};

/// Doubles the grid of one beam until it changes little.
EchoTruth converge(const Surface& surface, const EchoLaw& law, const RayOptions& options, double psi_low,
                   double psi_high) {
  EchoTruth truth;
  truth.beams = 1;
  truth.lines = law.lines();
  int scale = 1;
  for (int doubling = 0; doubling <= options.doublings; ++doubling, scale *= 2) {
    BeamGrid grid(surface, law, options);
    grid.integrate(psi_low, psi_high, options.columns * scale, options.rows * scale);
    std::vector<double> values = grid.values();
    truth.rays += grid.rays();
    truth.error = values;
    for (std::size_t k = 0; k < values.size(); ++k) {
      truth.error[k] = std::abs(values[k] - (truth.echo.empty() ? 0.0 : truth.echo[k]));
    }
    truth.echo = std::move(values);
    const RelativeError reached = estimated_error(truth);
    if (reached.rms <= options.error_rms && reached.max <= options.error_max) {
      break;
    }
  }
  return truth;
}

}  // namespace

EchoTruth integrate_rays(const Surface& surface, const EchoLaw& law, const RayOptions& options) {
  std::vector<int> beams = options.beams;
  if (beams.empty()) {
    beams.resize(static_cast<std::size_t>(law.beams()));
    std::iota(beams.begin(), beams.end(), 0);
  }
  EchoTruth truth;
  truth.beams = law.beams();
  truth.lines = law.lines();
  truth.echo.assign(static_cast<std::size_t>(truth.beams) * static_cast<std::size_t>(truth.lines), 0.0);
  truth.error = truth.echo;
  std::vector<std::uint64_t> rays(beams.size(), 0);
  for_each_beam(static_cast<int>(beams.size()), options.threads, [&](int i) {
    const auto beam = static_cast<std::size_t>(beams[static_cast<std::size_t>(i)]);
    const std::vector<double>& edges = law.beam_edges_rad();
    const EchoTruth one = converge(surface, law, options, edges.at(beam + 1), edges.at(beam));
    const auto begin = static_cast<std::ptrdiff_t>(beam) * truth.lines;
    std::copy(one.echo.begin(), one.echo.end(), truth.echo.begin() + begin);
    std::copy(one.error.begin(), one.error.end(), truth.error.begin() + begin);
    rays[static_cast<std::size_t>(i)] = one.rays;
  });
  truth.rays = std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
  return truth;
}

}  // namespace sonard::oracle
