// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/pulse.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/tone.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using Shape = PulseSettings::Shape;

/// sin(pi x) / (pi x): the time signal of an even band of frequencies.
double sinc_at(double x) {
  const double y = std::numbers::pi * x;
  return y == 0 ? 1.0 : std::sin(y) / y;
}

constexpr double reach_cells = 16;
constexpr int steps_per_cell = 32;  // of the integration

/// Intensity of a chirp `cells` away from the echo, re its peak.
double chirp_response(Shape shape, double cells) {
  double amplitude = sinc_at(cells);
  if (shape == Shape::windowed_chirp) {
    // The transform of a Hann window, sinc_at(x) / (1 - x^2), written as the sum that has no pole.
    amplitude += 0.5 * (sinc_at(cells - 1) + sinc_at(cells + 1));
  }
  return amplitude * amplitude;
}

/// Mean over two points, each uniform in its line, in lines `lines` apart: the density of their distance is a
/// triangle that falls to 0 one line to either side of `lines`.
double mean_chirp(Shape shape, int lines, double line_cells) {
  const int steps = 2 * std::max(1, static_cast<int>(std::ceil(line_cells * steps_per_cell)));
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double offset = 2 * (i + 0.5) / steps - 1;
    sum += (1 - std::abs(offset)) * chirp_response(shape, (lines + offset) * line_cells);
  }
  return sum * 2 / steps;
}

/// Mean over an echo that is uniform in its line, received in the middle of the line `lines` away.
double mean_rounded(const RoundedTone& tone, int lines, double step_m) {
  constexpr int steps = 64;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double amplitude = tone.amplitude((lines + (i + 0.5) / steps - 0.5) * step_m);
    sum += amplitude * amplitude;
  }
  return sum / steps;
}

/// The mean over a tone with sharp ends, exactly: differences of the second integral of a box.
double mean_tone(int lines, double line_cells) {
  const auto second_integral = [](double x) {
    const double inside = std::clamp(x, -0.5, 0.5);
    return 0.5 * (inside + 0.5) * (inside + 0.5) + (x - inside) * (x > 0 ? 1.0 : 0.0);
  };
  const double middle = lines * line_cells;
  return (second_integral(middle + line_cells) - 2 * second_integral(middle) +
          second_integral(middle - line_cells)) /
         (line_cells * line_cells);
}

SONARD_SIMD_CLONES
void add_scaled(const float* __restrict in, float share, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[i] += share * in[i];
  }
}

/// Mean of the response in an echo's own line and in all lines to one side of it that it reaches.
std::vector<double> mean_responses(Shape shape, double cell_m, double step_m, double tone_rounding_m) {
  const double line_cells = step_m / cell_m;
  std::vector<double> responses;
  const auto respond = [&](double reach_lines, auto mean) {
    for (int lines = 0; lines <= static_cast<int>(std::ceil(reach_lines)); ++lines) {
      responses.push_back(mean(lines));
    }
  };
  if (shape != Shape::tone) {
    respond(reach_cells / line_cells, [&](int lines) { return mean_chirp(shape, lines, line_cells); });
  } else if (tone_rounding_m > 0) {
    const RoundedTone tone(cell_m, tone_rounding_m);
    respond(tone.reach_m() / step_m, [&](int lines) { return mean_rounded(tone, lines, step_m); });
  } else {
    respond(0.5 / line_cells, [&](int lines) { return mean_tone(lines, line_cells); });
  }
  return responses;
}

/// Sum over both sides.
double total_of(const std::vector<double>& responses) {
  double total = 0;
  for (std::size_t lines = 0; lines < responses.size(); ++lines) {
    total += lines == 0 ? responses[lines] : 2 * responses[lines];
  }
  return total;
}

}  // namespace

double pulse_energy(const PulseSettings& pulse, double step_m) {
  const double band = decibels_to_power(pulse.band_loss_db);
  const UsualPulse& usual = pulse.usual;
  if (pulse.shape != Shape::tone || !(pulse.range_cell_m > 0) || !(usual.cell_m > 0)) {
    return band;
  }
  const auto lines = [&](double cell_m, double line_m) {
    return tone_length_m(cell_m, pulse.tone_rounding_m) / line_m;
  };
  return band * lines(pulse.range_cell_m, step_m) / lines(usual.cell_m, usual.step_m);
}

PulseResponse::PulseResponse(Shape shape, double cell_m, double step_m, double tone_rounding_m, double energy)
    : energy_(energy) {
  if (shape == Shape::point || !(cell_m > 0)) {
    return;
  }
  const std::vector<double> responses = mean_responses(shape, cell_m, step_m, tone_rounding_m);
  const double total = total_of(responses);
  for (const double response : responses) {
    share_.push_back(static_cast<float>(response / total * energy));
  }
}

void PulseResponse::apply(const EchoImage& echo, EchoImage& out, WorkerPool& workers) const {
  constexpr int beams_per_job = 8;
  const auto lines = static_cast<std::size_t>(echo.bins);
  out.beams = echo.beams;
  out.bins = echo.bins;
  out.intensity.resize(echo.intensity.size());
  workers.run((echo.beams + beams_per_job - 1) / beams_per_job, [&](int job) {
    const int end = std::min(echo.beams, (job + 1) * beams_per_job);
    for (int beam = job * beams_per_job; beam < end; ++beam) {
      const float* in = &echo.intensity[static_cast<std::size_t>(beam) * lines];
      float* spread = &out.intensity[static_cast<std::size_t>(beam) * lines];
      std::fill_n(spread, lines, 0.0F);
      for (std::size_t k = 0; k < std::min(share_.size(), lines); ++k) {
        add_scaled(in, share_[k], lines - k, spread + k);
        if (k > 0) {
          add_scaled(in + k, share_[k], lines - k, spread);
        }
      }
    }
  });
}

namespace {

constexpr int most_lines_each_side = 32;

/// Amplitude received `lines` away from an echo, not normalised; 0 beyond the main lobe. A tone has sharp
/// ends here.
double pulse_amplitude(Shape shape, int lines, double line_cells) {
  const double cells = lines * line_cells;
  switch (shape) {
    case Shape::point:
      return lines == 0 ? 1.0 : 0.0;
    case Shape::chirp:
      return cells < 1 ? sinc_at(cells) : 0.0;
    case Shape::windowed_chirp:  // the transform of a Hann window
      return cells < 2 ? sinc_at(cells) + 0.5 * (sinc_at(cells - 1) + sinc_at(cells + 1)) : 0.0;
    case Shape::tone:
      return std::max(0.0, std::min(0.5, cells + line_cells / 2) - std::max(-0.5, cells - line_cells / 2));
  }
  return 0.0;
}

SONARD_SIMD_CLONES
void weigh_row(const float* __restrict row, float weight, int width, float* __restrict out) {
  for (int i = 0; i < width; ++i) {
    out[i] = weight * row[i];
  }
}

SONARD_SIMD_CLONES
void add_pair(const float* before, const float* after, float weight, int width, float* __restrict out) {
  for (int i = 0; i < width; ++i) {
    out[i] += weight * (before[i] + after[i]);
  }
}

}  // namespace

PulseCorrelation::PulseCorrelation(Shape shape, double cell_m, double step_m, double tone_rounding_m) {
  if (!(cell_m > 0)) {
    return;
  }
  std::optional<RoundedTone> rounded;
  if (shape == Shape::tone && tone_rounding_m > 0) {
    rounded.emplace(cell_m, tone_rounding_m);
  }
  std::vector<double> amplitudes;
  double power = 0;
  for (int j = 0; j <= most_lines_each_side; ++j) {
    const double amplitude =
        rounded ? rounded->amplitude(j * step_m) : pulse_amplitude(shape, j, step_m / cell_m);
    if (!(amplitude > 0)) {
      break;
    }
    amplitudes.push_back(amplitude);
    power += (j == 0 ? 1 : 2) * amplitude * amplitude;
  }
  weights_.clear();
  std::transform(amplitudes.begin(), amplitudes.end(), std::back_inserter(weights_),
                 [&](double amplitude) { return static_cast<float>(amplitude / std::sqrt(power)); });
}

void PulseCorrelation::apply(const std::vector<const float*>& rows, int width, float* out) const {
  const auto middle = weights_.size() - 1;
  weigh_row(rows[middle], weights_[0], width, out);
  for (std::size_t j = 1; j < weights_.size(); ++j) {
    add_pair(rows[middle - j], rows[middle + j], weights_[j], width, out);
  }
}

}  // namespace sonard::render
