#include "renderer/acoustics/range_response.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr double reach_cells = 16;
constexpr int steps_per_cell = 32;  // of the integration

double response(double cells) {
  const double x = std::numbers::pi * cells;
  return x == 0 ? 1.0 : std::pow(std::sin(x) / x, 2);
}

/// Two points that lie evenly in lines `lines` apart are x apart with a density that falls to 0 a line to
/// either side of that.
double mean_response(int lines, double line_cells) {
  const int steps = 2 * std::max(1, static_cast<int>(std::ceil(line_cells * steps_per_cell)));
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double offset = 2 * (i + 0.5) / steps - 1;
    sum += (1 - std::abs(offset)) * response((lines + offset) * line_cells);
  }
  return sum * 2 / steps;
}

SONARD_SIMD_CLONES
void add_scaled(const float* __restrict in, float share, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[i] += share * in[i];
  }
}

}  // namespace

RangeResponse::RangeResponse(double cell_m, double step_m) {
  if (!(cell_m > 0)) {
    return;
  }
  const double line_cells = step_m / cell_m;
  const int reach = static_cast<int>(std::ceil(reach_cells / line_cells));
  std::vector<double> shares;
  double total = 0;
  for (int lines = 0; lines <= reach; ++lines) {
    shares.push_back(mean_response(lines, line_cells));
    total += lines == 0 ? shares.back() : 2 * shares.back();
  }
  for (const double share : shares) {
    share_.push_back(static_cast<float>(share / total));
  }
}

void RangeResponse::apply(const EchoImage& echo, EchoImage& out) const {
  const auto lines = static_cast<std::size_t>(echo.lines);
  out.beams = echo.beams;
  out.lines = echo.lines;
  out.intensity.assign(echo.intensity.size(), 0.0F);
  for (std::size_t begin = 0; begin < echo.intensity.size(); begin += lines) {
    const float* in = &echo.intensity[begin];
    float* spread = &out.intensity[begin];
    for (std::size_t k = 0; k < std::min(share_.size(), lines); ++k) {
      add_scaled(in, share_[k], lines - k, spread + k);
      if (k > 0) {
        add_scaled(in + k, share_[k], lines - k, spread);
      }
    }
  }
}

}  // namespace sonard::render
