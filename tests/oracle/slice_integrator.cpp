// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/slice_integrator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <utility>

#include "tests/oracle/beam_threads.hpp"
#include "tests/oracle/neumaier.hpp"
#include "tests/oracle/slice.hpp"

namespace sonard::oracle {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double nominal_beam_rad = pi / 360;

/// Azimuths that a facet covers: [from, to], from in [-pi, pi], to - from <= 2 pi.
struct AzimuthSpan {
  double from, to;

  bool overlaps(double low, double high) const {
    return (from <= high && to >= low) || (from <= high + 2 * pi && to >= low + 2 * pi) ||
           (from <= high - 2 * pi && to >= low - 2 * pi);
  }
};

/// The span may be too large, never too small: a facet that touches the z axis covers all azimuths.
AzimuthSpan span_of(const Facet& facet) {
  std::array<double, 3> psi{};
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3& p = facet.corners[i];
    if (p.x == 0 && p.y == 0) {
      return {-pi, pi};
    }
    psi[i] = std::atan2(p.y, p.x);
  }
  std::sort(psi.begin(), psi.end());
  // The facet does not cover the widest gap between neighbouring corners, unless it contains the z axis.
  const std::array<double, 3> gap = {psi[1] - psi[0], psi[2] - psi[1], psi[0] + 2 * pi - psi[2]};
  constexpr double rounding = 1e-9;
  if (gap[2] >= pi - rounding) {
    return {psi[0], psi[2]};
  }
  if (gap[0] >= pi - rounding) {
    return {psi[1], psi[0] + 2 * pi};
  }
  if (gap[1] >= pi - rounding) {
    return {psi[2], psi[1] + 2 * pi};
  }
  return {-pi, pi};
}

/// Sorts, and drops values that nearly equal their neighbour.
void sort_apart(std::vector<double>& azimuths) {
  constexpr double same_rad = 1e-11;
  std::sort(azimuths.begin(), azimuths.end());
  azimuths.erase(
      std::unique(azimuths.begin(), azimuths.end(), [](double a, double b) { return b - a < same_rad; }),
      azimuths.end());
}

// Kronrod's rule with 7 nodes on [-1, 1], an extension of Gauss's rule with 3 nodes.
struct Node {
  double at, kronrod, gauss;
};
constexpr std::array<Node, 7> rule = {{{-0.960491268708020283, 0.104656226026467265, 0.0},
                                       {-0.774596669241483377, 0.268488089868333441, 5.0 / 9},
                                       {-0.434243749346802558, 0.401397414775962223, 0.0},
                                       {0.0, 0.450916538658474142, 8.0 / 9},
                                       {0.434243749346802558, 0.401397414775962223, 0.0},
                                       {0.774596669241483377, 0.268488089868333441, 5.0 / 9},
                                       {0.960491268708020283, 0.104656226026467265, 0.0}}};

/// A part of a beam and the result of its slices.
struct Interval {
  double from, to;
  std::vector<std::uint32_t> candidates;
  LineSums sums;
  LineSums error;        // absolute error of each sum
  double badness = 0.0;  // largest error relative to the beam's value
};

/// sums += factor * terms
void accumulate(std::vector<double>& sums, double factor, const std::vector<double>& terms) {
  for (std::size_t k = 0; k < sums.size(); ++k) {
    sums[k] += factor * terms[k];
  }
}

void make_absolute(std::vector<double>& values) {
  for (double& value : values) {
    value = std::abs(value);
  }
}

class BeamIntegrator {
 public:
  BeamIntegrator(const Facets& facets, const std::vector<AzimuthSpan>& spans, const EchoLaw& law,
                 const SliceOptions& options)
      : facets_(facets),
        spans_(spans),
        law_(law),
        options_(options),
        slicer_(facets, law),
        total_(law),
        error_(total_.echo) {}

  /// Integrates the beam from `low` to `high`. Writes law.lines() values and errors. @return number of slices
  std::uint64_t integrate(double low, double high, double* echo, double* error) {
    start(low, high);
    while (!done() && slices_ + 2 * rule.size() <= static_cast<std::size_t>(options_.max_slices_per_beam)) {
      halve_worst();
    }
    write(echo, error);
    return slices_;
  }

 private:
  void start(double low, double high) {
    std::vector<std::uint32_t> all(spans_.size());
    std::iota(all.begin(), all.end(), 0U);
    std::erase_if(all, [&](std::uint32_t i) { return !spans_[i].overlaps(low, high); });
    const std::vector<double> edges = first_edges(low, high, all);
    intervals_.reserve(edges.size());
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
      intervals_.push_back(measure(edges[i], edges[i + 1], all));
      apply(intervals_.back(), 1.0);
    }
    for (Interval& interval : intervals_) {
      rate(interval);
      queue_.emplace(interval.badness, static_cast<std::size_t>(&interval - intervals_.data()));
    }
  }

  /// Initial division of the beam, in ascending order.
  std::vector<double> first_edges(double low, double high,
                                  const std::vector<std::uint32_t>& candidates) const {
    const double nominal_beams = std::max(1.0, std::ceil((high - low) / nominal_beam_rad - 1e-6));
    const int count = options_.first_intervals * static_cast<int>(nominal_beams);
    std::vector<double> edges;
    edges.reserve(static_cast<std::size_t>(count) + 1);
    for (int i = 0; i < count; ++i) {
      edges.push_back(low + (high - low) * i / count);
    }
    std::vector<double> corners = corner_azimuths(low, high, candidates);
    if (corners.size() <= static_cast<std::size_t>(options_.max_corners)) {
      edges.insert(edges.end(), corners.begin(), corners.end());
    }
    edges.push_back(high);
    sort_apart(edges);
    edges.back() = high;
    return edges;
  }

  std::vector<double> corner_azimuths(double low, double high,
                                      const std::vector<std::uint32_t>& candidates) const {
    std::vector<double> azimuths;
    if (options_.max_corners == 0) {
      return azimuths;
    }
    for (const std::uint32_t i : candidates) {
      for (const glm::dvec3& corner : facets_.all()[i].corners) {
        const double psi = std::atan2(corner.y, corner.x);
        for (const double turned : {psi - 2 * pi, psi, psi + 2 * pi}) {
          if (turned > low && turned < high) {
            azimuths.push_back(turned);
          }
        }
      }
    }
    sort_apart(azimuths);
    return azimuths;
  }

  Interval measure(double from, double to, const std::vector<std::uint32_t>& candidates) {
    Interval interval{from, to, {}, LineSums(law_), LineSums(law_)};
    std::copy_if(candidates.begin(), candidates.end(), std::back_inserter(interval.candidates),
                 [&](std::uint32_t i) { return spans_[i].overlaps(from, to); });
    const double half = (to - from) / 2;
    for (const Node& node : rule) {
      LineSums slice(law_);
      slicer_.add(from + half + node.at * half, interval.candidates, slice);
      accumulate(interval.sums.echo, half * node.kronrod, slice.echo);
      accumulate(interval.sums.weight, half * node.kronrod, slice.weight);
      accumulate(interval.error.echo, half * (node.kronrod - node.gauss), slice.echo);
      accumulate(interval.error.weight, half * (node.kronrod - node.gauss), slice.weight);
    }
    make_absolute(interval.error.echo);
    make_absolute(interval.error.weight);
    slices_ += rule.size();
    return interval;
  }

  /// Adds (sign 1) or subtracts (sign -1) an interval. These running totals only control the refinement.
  void apply(const Interval& interval, double sign) {
    accumulate(total_.echo, sign, interval.sums.echo);
    accumulate(error_, sign, interval.error.echo);
  }

  double strongest() const { return *std::max_element(total_.echo.begin(), total_.echo.end()); }

  void rate(Interval& interval) const {
    const double floor = 1e-4 * strongest();
    interval.badness = 0;
    for (std::size_t k = 0; k < total_.echo.size(); ++k) {
      const double scale = std::max(total_.echo[k], floor);
      interval.badness =
          scale > 0 ? std::max(interval.badness, interval.error.echo[k] / scale) : interval.badness;
    }
  }

  bool done() const {
    const double top = strongest();
    double squares = 0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < total_.echo.size(); ++k) {
      if (!(total_.echo[k] > 1e-4 * top)) {
        continue;
      }
      const double relative = error_[k] / total_.echo[k];
      if (relative > options_.error_max) {
        return false;
      }
      if (total_.echo[k] > 1e-2 * top) {
        squares += relative * relative;
        ++count;
      }
    }
    return count == 0 || squares <= options_.error_rms * options_.error_rms * static_cast<double>(count);
  }

  void halve_worst() {
    const std::size_t worst = queue_.top().second;
    queue_.pop();
    const Interval parent = std::move(intervals_[worst]);
    apply(parent, -1.0);
    const double middle = (parent.from + parent.to) / 2;
    Interval low = measure(parent.from, middle, parent.candidates);
    Interval high = measure(middle, parent.to, parent.candidates);
    apply(low, 1.0);
    apply(high, 1.0);
    rate(low);
    rate(high);
    queue_.emplace(low.badness, worst);
    queue_.emplace(high.badness, intervals_.size());
    intervals_[worst] = std::move(low);
    intervals_.push_back(std::move(high));
  }

  void write(double* echo, double* error) const {
    for (std::size_t k = 0; k < total_.echo.size(); ++k) {
      echo[k] = total(k, &Interval::sums, &LineSums::echo);
      error[k] = total(k, &Interval::error, &LineSums::echo);
      if (law_.is_mean()) {
        const double weight = total(k, &Interval::sums, &LineSums::weight);
        const double scale = weight > 0 ? 1 / weight : 0.0;
        echo[k] *= scale;
        error[k] = (error[k] + echo[k] * total(k, &Interval::error, &LineSums::weight)) * scale;
      }
    }
  }

  double total(std::size_t line, LineSums Interval::*which, std::vector<double> LineSums::*value) const {
    NeumaierSum sum;
    for (const Interval& interval : intervals_) {
      sum.add((interval.*which.*value)[line]);
    }
    return sum.value();
  }

  const Facets& facets_;
  const std::vector<AzimuthSpan>& spans_;
  const EchoLaw& law_;
  const SliceOptions& options_;
  Slicer slicer_;
  std::vector<Interval> intervals_;
  std::priority_queue<std::pair<double, std::size_t>> queue_;  // badness, index of the interval
  LineSums total_;
  std::vector<double> error_;
  std::size_t slices_ = 0;
};

}  // namespace

EchoTruth integrate_slices(const Facets& facets, const EchoLaw& law, const SliceOptions& options) {
  std::vector<AzimuthSpan> spans;
  spans.reserve(facets.all().size());
  for (const Facet& facet : facets.all()) {
    spans.push_back(span_of(facet));
  }
  std::vector<int> beams = options.beams;
  if (beams.empty()) {
    beams.resize(static_cast<std::size_t>(law.beams()));
    std::iota(beams.begin(), beams.end(), 0);
  }
  EchoTruth truth;
  truth.beams = law.beams();
  truth.lines = law.lines();
  const auto lines = static_cast<std::size_t>(truth.lines);
  truth.echo.assign(static_cast<std::size_t>(truth.beams) * lines, 0.0);
  truth.error = truth.echo;
  std::vector<std::uint64_t> slices(beams.size(), 0);
  for_each_beam(static_cast<int>(beams.size()), options.threads, [&](int i) {
    const auto index = static_cast<std::size_t>(i);
    const auto beam = static_cast<std::size_t>(beams[index]);
    const std::vector<double>& edges = law.beam_edges_rad();
    BeamIntegrator integrator(facets, spans, law, options);
    slices[index] = integrator.integrate(edges.at(beam + 1), edges.at(beam), &truth.echo[beam * lines],
                                         &truth.error[beam * lines]);
  });
  truth.rays = std::accumulate(slices.begin(), slices.end(), std::uint64_t{0});
  return truth;
}

}  // namespace sonard::oracle
