// SPDX-License-Identifier: Apache-2.0
#include "renderer/binning/cone_bearing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sonard::render {

namespace {

constexpr double most_move = 0.25;  // change of bearing within one part of a patch, in beams

double cosine_of(double tangent) {
  return 1 / std::sqrt(1 + tangent * tangent);
}

/// `share` of the part of a patch between the fractions `from` and `to` of the way from its end a to its end
/// b.
EchoPatch part_of(const EchoPatch& patch, float from, float to, float share) {
  const auto between = [](float a, float b, float at) { return a + (b - a) * at; };
  const float length = to - from;
  // Echo and weight per metre are linear.
  const auto mean = [&](float gradient) { return 1 + gradient * (from + to - 1); };
  EchoPatch part = patch;
  part.range_a_m = between(patch.range_a_m, patch.range_b_m, from);
  part.range_b_m = between(patch.range_a_m, patch.range_b_m, to);
  part.smear_a_m = between(patch.smear_a_m, patch.smear_b_m, from);
  part.smear_b_m = between(patch.smear_a_m, patch.smear_b_m, to);
  part.tangent_a = between(patch.tangent_a, patch.tangent_b, from);
  part.tangent_b = between(patch.tangent_a, patch.tangent_b, to);
  part.echo = patch.echo * length * share * mean(patch.echo_gradient);
  part.weight = patch.weight * length * share * mean(patch.weight_gradient);
  const auto gradient_of_part = [&](float gradient) {
    return mean(gradient) > 0 ? std::min(1.0F, std::max(-1.0F, gradient * length / mean(gradient))) : 0.0F;
  };
  part.echo_gradient = gradient_of_part(patch.echo_gradient);
  part.weight_gradient = gradient_of_part(patch.weight_gradient);
  return part;
}

}  // namespace

ConeBearings::ConeBearings(const Aperture& aperture, std::vector<PatchColumn> columns)
    : columns_(std::move(columns)), least_cosine_(std::cos(aperture.elevation_limit_rad())) {
  std::sort(columns_.begin(), columns_.end(),
            [](const PatchColumn& a, const PatchColumn& b) { return a.port_rad > b.port_rad; });
  for (const double edge_rad : aperture.beam_edges_rad) {
    edges_sine_.push_back(std::sin(edge_rad));
  }
  for (const PatchColumn& column : columns_) {
    columns_port_sine_.push_back(std::sin(column.port_rad));
  }
}

void ConeBearings::patches_of(int beam, std::vector<EchoPatch>& patches) const {
  const auto b = static_cast<std::size_t>(beam);
  const double port = edges_sine_[b];
  const double starboard = edges_sine_[b + 1];
  // Patches off the horizontal appear nearer to the axis.
  const double farthest_port = port > 0 ? port / least_cosine_ : port;
  const double farthest_starboard = starboard < 0 ? starboard / least_cosine_ : starboard;
  patches.clear();
  // The last column that begins to port of the farthest.
  auto first = std::upper_bound(columns_port_sine_.begin(), columns_port_sine_.end(), farthest_port,
                                [](double sine, double column) { return sine > column; });
  first -= first == columns_port_sine_.begin() ? 0 : 1;
  for (auto i = static_cast<std::size_t>(first - columns_port_sine_.begin());
       i < columns_.size() && columns_port_sine_[i] > farthest_starboard; ++i) {
    const PatchColumn& column = columns_[i];
    const double column_port = columns_port_sine_[i];
    const double column_starboard = std::sin(column.starboard_rad);
    for (const EchoPatch* patch = column.begin; patch != column.end; ++patch) {
      const auto tangent_a = static_cast<double>(patch->tangent_a);
      const auto tangent_b = static_cast<double>(patch->tangent_b);
      const double farthest = std::max(std::abs(column_port), std::abs(column_starboard));
      // d cos theta / d tan theta is below tan theta.
      const double steepest = std::max(std::abs(tangent_a), std::abs(tangent_b));
      const double moved = farthest * steepest * std::abs(tangent_b - tangent_a);
      const int parts = std::max(1, static_cast<int>(std::ceil(moved / (most_move * (port - starboard)))));
      for (int k = 0; k < parts; ++k) {
        const double from = static_cast<double>(k) / parts;
        const double to = (k + 1.0) / parts;
        const double cosine = cosine_of(tangent_a + (tangent_b - tangent_a) * (from + to) / 2);
        const double low = std::max(starboard, column_starboard * cosine);
        const double high = std::min(port, column_port * cosine);
        if (high > low) {
          const double share = (high - low) / ((column_port - column_starboard) * cosine);
          patches.push_back(
              part_of(*patch, static_cast<float>(from), static_cast<float>(to), static_cast<float>(share)));
        }
      }
    }
  }
}

}  // namespace sonard::render
