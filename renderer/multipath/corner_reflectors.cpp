// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/corner_reflectors.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

// The aperture is weighted with a bell, bell_width sqrt(r / k) wide, out to bell_reach widths: a few Fresnel
// zones. The echo of a large corner then has no ripple of a sharp edge and is accurate to 0.2 %.
constexpr double bell_width = 4.0;
constexpr double bell_reach = 2.5;
constexpr int search_cells = 24;   // along each side, to find the aperture
constexpr int closest_search = 4;  // searches, each in a field a quarter as wide as the last
constexpr int cells = 48;          // along each side, for the sum
constexpr int phases_per_cell = 8;

/// A rectangle along s and t in the plane perpendicular to the line to the image, metres.
struct Field {
  double low_s = 0.0, high_s = 0.0, low_t = 0.0, high_t = 0.0;
};

/// Largest distance between images of one corner: an eighth of a wavelength, or the rounding error.
double tolerance_m(const glm::dvec3& image_m, double wavelength_m) {
  return std::max(wavelength_m / 8, 1e-5 * glm::length(image_m));
}

class CornerView {
 public:
  CornerView(const PathScene& scene, const CornerCandidate& candidate, const PathLimits& limits)
      : scene_(scene), limits_(limits), image_m_(candidate.image_m) {
    range_m_ = 0.5 * glm::length(image_m_);
    ahead_ = image_m_ / (2 * range_m_);
    const glm::dvec3 aside = std::abs(ahead_.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
    s_ = glm::normalize(glm::cross(aside, ahead_));
    t_ = glm::cross(ahead_, s_);
    wave_number_ = 2 * std::numbers::pi / limits.wavelength_m;
    bell_m_ = bell_width * std::sqrt(range_m_ / wave_number_);
  }

  double range_m() const { return range_m_; }

  /// The part of the plane that sends rays to the image, with a margin; empty if no ray reaches it.
  Field find_aperture() const {
    double reach = bell_reach * bell_m_;
    for (int i = 0; i < closest_search; ++i, reach /= 4) {
      const double step = 2 * reach / search_cells;
      Field found{reach, -reach, reach, -reach};
      for (int j = 0; j < search_cells * search_cells; ++j) {
        const double s = (j % search_cells + 0.5) * step - reach;
        const double t = (j / search_cells + 0.5) * step - reach;
        if (pressure(s, t) != 0.0) {
          found = {std::min(found.low_s, s - step), std::max(found.high_s, s + step),
                   std::min(found.low_t, t - step), std::max(found.high_t, t + step)};
        }
      }
      if (found.low_s < found.high_s) {
        return found;
      }
    }
    return {};
  }

  /// The integral over the field, m^2.
  std::complex<double> integral(const Field& field) const {
    const Phases along_s = phases(field.low_s, field.high_s);
    const Phases along_t = phases(field.low_t, field.high_t);
    std::complex<double> sum = 0.0;
    for (std::size_t i = 0; i < cells; ++i) {
      for (std::size_t j = 0; j < cells; ++j) {
        sum += pressure(along_s.middle[i], along_t.middle[j]) * along_s.integral[i] * along_t.integral[j];
      }
    }
    return sum;
  }

 private:
  struct Phases {
    std::array<double, cells> middle{};
    std::array<std::complex<double>, cells> integral{};  ///< over the cell, of bell and exp(i k x^2 / r)
  };

  Phases phases(double low, double high) const {
    Phases of;
    const double step = (high - low) / cells;
    for (std::size_t i = 0; i < cells; ++i) {
      of.middle[i] = low + (static_cast<double>(i) + 0.5) * step;
      for (int j = 0; j < phases_per_cell; ++j) {
        const double x = of.middle[i] + step * ((j + 0.5) / phases_per_cell - 0.5);
        of.integral[i] += std::polar(std::exp(-0.5 * (x / bell_m_) * (x / bell_m_)) * step / phases_per_cell,
                                     wave_number_ * x * x / range_m_);
      }
    }
    return of;
  }

  /// Factor of the mirrors on the pressure of the ray through a point of the plane; 0 if they do not send it
  /// to the image.
  double pressure(double s, double t) const {
    glm::dvec3 direction = glm::normalize(range_m_ * ahead_ + s * s_ + t * t_);
    std::array<PathHit, 3> hits;
    PathHit here;
    double factor = 1.0;
    double left_m = 2 * range_m_;
    for (std::size_t n = 0; n < hits.size(); ++n) {
      if (!scene_.trace(here.position_m, here.normal, direction, left_m, hits[n]) ||
          !scene_.is_flat(hits[n])) {
        return 0.0;
      }
      here = hits[n];
      const Mirror& mirror = scene_.mirror(here);
      if (!(mirror.gain(here.cosine, limits_.wavelength_m) > limits_.least_gain)) {
        return 0.0;
      }
      factor *= mirror.pressure(here.cosine, limits_.wavelength_m);
      direction = reflected(direction, here.normal);
      left_m -= here.distance_m;
      if (n > 0 && is_image(hits, n)) {
        return left_m > 0 && scene_.is_free(here.position_m, here.normal, direction, left_m) ? factor : 0.0;
      }
    }
    return 0.0;
  }

  /// True if the image of the sonar in the mirrors up to number `last` is the candidate's.
  bool is_image(const std::array<PathHit, 3>& hits, std::size_t last) const {
    glm::dvec3 image_m(0.0);
    for (std::size_t i = last + 1; i-- > 0;) {
      image_m = mirrored(image_m, hits[i]);
    }
    return glm::length(image_m - image_m_) < tolerance_m(image_m_, limits_.wavelength_m);
  }

  const PathScene& scene_;
  const PathLimits& limits_;
  glm::dvec3 image_m_;
  double range_m_ = 0.0, wave_number_ = 0.0, bell_m_ = 0.0;
  glm::dvec3 ahead_{1, 0, 0}, s_{0, 1, 0}, t_{0, 0, 1};
};

}  // namespace

CornerReflector corner_reflector(const PathScene& scene, const CornerCandidate& candidate,
                                 const PathLimits& limits) {
  const CornerView view(scene, candidate, limits);
  const double r = view.range_m();
  const double pressure = std::abs(view.integral(view.find_aperture())) / (limits.wavelength_m * r * r);
  return {0.5 * candidate.image_m, pressure * pressure};
}

std::vector<CornerCandidate> distinct_corners(const std::vector<GhostPaths::Result>& results,
                                              const GhostPaths::Result& more, const PathLimits& limits) {
  std::vector<CornerCandidate> distinct;
  const auto add = [&](const CornerCandidate& corner) {
    const double apart_m = 2 * tolerance_m(corner.image_m, limits.wavelength_m);
    const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const CornerCandidate& other) {
      return glm::length(other.image_m - corner.image_m) < apart_m;
    });
    if (!known) {
      distinct.push_back(corner);
    }
  };
  for (const GhostPaths::Result& result : results) {
    std::for_each(result.corners.begin(), result.corners.end(), add);
  }
  std::for_each(more.corners.begin(), more.corners.end(), add);
  return distinct;
}

}  // namespace sonard::render
