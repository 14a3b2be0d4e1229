// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/image_error.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>

namespace sonard::bench {

namespace {

constexpr double loud = 1e-2;   // relative to the beam's maximum: errors are counted on bins above this
constexpr double faint = 1e-6;  // -60 dB
constexpr double hole = 1e-3;   // relative to the reference of the same bin
constexpr double trimmed_share = 0.01;

using Beam = std::span<const float>;

Beam beam_of(const render::EchoImage& image, int beam) {
  const auto lines = static_cast<std::size_t>(image.bins);
  return Beam(image.intensity).subspan(static_cast<std::size_t>(beam) * lines, lines);
}

double sum(Beam beam) {
  return std::accumulate(beam.begin(), beam.end(), 0.0);
}

/// Range at which the summed echo reaches `level`, in lines from the sonar; the beam's length if it never
/// does.
double first_echo(Beam beam, double level) {
  double reached = 0;
  for (std::size_t k = 0; k < beam.size(); ++k) {
    const auto echo = static_cast<double>(beam[k]);
    if (reached + echo >= level) {
      return static_cast<double>(k) + (level - reached) / echo;
    }
    reached += echo;
  }
  return static_cast<double>(beam.size());
}

/// Centroid of the echo, in lines from the sonar.
double centroid(Beam beam) {
  double moment = 0;
  for (std::size_t k = 0; k < beam.size(); ++k) {
    moment += static_cast<double>(k) * static_cast<double>(beam[k]);
  }
  return moment / sum(beam);
}

double strongest_of(Beam beam) {
  return static_cast<double>(*std::max_element(beam.begin(), beam.end()));
}

double root_mean(std::span<const double> squares) {
  return std::sqrt(std::accumulate(squares.begin(), squares.end(), 0.0) /
                   static_cast<double>(squares.size()));
}

struct Share {
  std::uint64_t hits = 0, all = 0;
  void count(bool hit) {
    hits += hit ? 1 : 0;
    ++all;
  }
  double value() const { return all == 0 ? 0 : static_cast<double>(hits) / static_cast<double>(all); }
};

}  // namespace

std::optional<ImageError> compare_images(const render::EchoImage& image, const render::EchoImage& reference) {
  if (image.beams != reference.beams || image.bins != reference.bins) {
    throw std::invalid_argument("image and reference differ in size");
  }
  ImageError error;
  std::vector<double> squares;
  Share holes, faint_holes;
  int heard_beams = 0;
  for (int b = 0; b < reference.beams; ++b) {
    const Beam truth = beam_of(reference, b), measured = beam_of(image, b);
    const double strongest = strongest_of(truth);
    if (strongest <= 0) {
      continue;
    }
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto expected = static_cast<double>(truth[k]);
      const auto found = static_cast<double>(measured[k]);
      const bool empty = found < hole * expected;
      if (expected > loud * strongest) {
        squares.push_back((found / expected - 1) * (found / expected - 1));
        holes.count(empty);
      }
      if (expected > faint * strongest) {
        faint_holes.count(empty);
      }
    }
    const double level = loud * strongest;
    error.first_echo_bins =
        std::max(error.first_echo_bins, std::abs(first_echo(measured, level) - first_echo(truth, level)));
    const double total = std::abs(sum(measured) / sum(truth) - 1);
    error.beam_total_mean += total;
    error.beam_total_worst = std::max(error.beam_total_worst, total);
    ++heard_beams;
  }
  if (heard_beams == 0) {
    return std::nullopt;
  }
  error.beam_total_mean /= heard_beams;
  error.hole_fraction = holes.value();
  error.hole_fraction_60db = faint_holes.value();
  error.bins = squares.size();
  error.bin_rms = root_mean(squares);
  std::sort(squares.begin(), squares.end());
  const auto dropped = static_cast<std::size_t>(trimmed_share * static_cast<double>(squares.size()));
  error.bin_rms_trim = root_mean(std::span(squares).first(squares.size() - dropped));
  return error;
}

std::vector<BeamError> compare_beams(const render::EchoImage& image, const render::EchoImage& reference) {
  std::vector<BeamError> errors;
  for (int b = 0; b < reference.beams; ++b) {
    const Beam truth = beam_of(reference, b), measured = beam_of(image, b);
    const double strongest = strongest_of(truth);
    if (strongest <= 0) {
      continue;
    }
    const double level = loud * strongest;
    errors.push_back({std::abs(sum(measured) / sum(truth) - 1),
                      std::abs(centroid(measured) - centroid(truth)),
                      std::abs(first_echo(measured, level) - first_echo(truth, level))});
  }
  return errors;
}

}  // namespace sonard::bench
