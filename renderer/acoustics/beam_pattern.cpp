// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/beam_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/acoustics/line_array.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr double faintest_in_band = 1e-4;  // of the axis
constexpr int lines_per_tile = 32;         // a tile is even or not as a whole
constexpr float linearity = 0.01F;
constexpr int rows_per_pass = 4;

/// Adds a row to the sum and updates the least and the most echo per angle.
SONARD_SIMD_CLONES
void gather_row(const float* __restrict in, float inverse_width, int count, float* __restrict sum,
                float* __restrict least, float* __restrict most) {
  for (int k = 0; k < count; ++k) {
    const float density = in[k] * inverse_width;
    sum[k] += in[k];
    least[k] = density < least[k] ? density : least[k];
    most[k] = density > most[k] ? density : most[k];
  }
}

SONARD_SIMD_CLONES
void add_four_rows(const float* __restrict in, std::size_t stride, const float* weights, int count,
                   float* __restrict out) {
  const float* a = in;
  const float* b = a + stride;
  const float* c = b + stride;
  const float* d = c + stride;
  const float wa = weights[0];
  const float wb = weights[1];
  const float wc = weights[2];
  const float wd = weights[3];
  for (int k = 0; k < count; ++k) {
    out[k] += (wa * a[k] + wb * b[k]) + (wc * c[k] + wd * d[k]);
  }
}

SONARD_SIMD_CLONES
void add_row(const float* __restrict in, float weight, int count, float* __restrict out) {
  for (int k = 0; k < count; ++k) {
    out[k] += weight * in[k];
  }
}

SONARD_SIMD_CLONES
void set_row(const float* __restrict in, float weight, int count, float* __restrict out) {
  for (int k = 0; k < count; ++k) {
    out[k] = weight * in[k];
  }
}

}  // namespace

/// Look-up table of the pattern of one array against sine.
class PatternTable {
 public:
  PatternTable(const Aperture& aperture, RandomKey key)
      : spacing_(2.0 / element_count(aperture)), reach_(reach(aperture)) {
    const LineArray array(aperture, key);
    floor_ = array.mean_error_power();
    const int half = static_cast<int>(std::ceil(reach_ * steps_per_sine())) + 1;
    for (int i = -half; i <= half; ++i) {
      power_.push_back(array.power(i / steps_per_sine()));
    }
  }

  /// Farthest direction in the band, in sine.
  double reach() const { return reach_; }
  double floor() const { return floor_; }
  /// Mean power above the floor in a fine beam between two offsets in sine (from < to); exactly 0 outside the
  /// band.
  double excess(double from, double to) const {
    const int points = std::max(1, static_cast<int>(std::ceil((to - from) / spacing_ - 1e-9)));
    double sum = 0;
    for (int i = 0; i < points; ++i) {
      sum += excess_at(from + (to - from) * (i + 0.5) / points);
    }
    return sum / points;
  }

 private:
  static constexpr int steps_per_spacing = 64;  // linear interpolation is accurate to 0.2 %

  double steps_per_sine() const { return steps_per_spacing / spacing_; }

  double excess_at(double sine_offset) const {
    const double folded = sine_offset - 2 * std::round(sine_offset / 2);
    if (std::abs(folded) > reach_) {
      return 0;
    }
    const double x = folded * steps_per_sine() + 0.5 * static_cast<double>(power_.size() - 1);
    const auto i = static_cast<std::size_t>(x);
    const double part = x - std::floor(x);
    return power_[i] * (1 - part) + power_[i + 1] * part - floor_;
  }

  /// Computed with a shorter array: the pattern of a long array is that pattern, scaled.
  static double reach(Aperture aperture) {
    constexpr int enough_elements = 256;
    const double scale = std::max(1.0, static_cast<double>(element_count(aperture)) / enough_elements);
    aperture.receive_beamwidth_rad *= scale;
    return reach(LineArray(aperture)) / scale;
  }

  static double reach(const LineArray& array) {
    const double step = 0.125 / array.elements();
    double offset = 1.0;  // the pattern of half-wave elements is symmetric, with period 2
    while (offset > step && array.power(offset) <= faintest_in_band) {
      offset -= step;
    }
    return std::min(1.0, offset + step);
  }

  double spacing_;
  double reach_;
  double floor_ = 0.0;
  std::vector<double> power_;
};

struct BeamPattern::LineSums {
  std::vector<float> sum, least, most;  ///< per line; least and most are echo per angle
};

/// Lines [begin, end), all even or all not.
struct BeamPattern::Span {
  int begin = 0, end = 0;
  bool even = false;
};

namespace {
constexpr double farthest_sine = 0.9998;  // 89 degrees
}  // namespace

int fine_beams_beyond(const Aperture& aperture) {
  const std::vector<double>& edges = aperture.beam_edges_rad;
  const double end = std::max(std::sin(edges.front()), -std::sin(edges.back()));
  if (aperture.bearing == Aperture::Bearing::planar || !(end > 0)) {
    return 0;
  }
  const double farthest = std::min(end / std::cos(aperture.elevation_limit_rad()), farthest_sine);
  const double spacing = (std::sin(edges.front()) - std::sin(edges.back())) /
                         static_cast<double>(edges.size() - 1) / aperture.fine_beams;
  const double room = farthest_sine - std::max(std::sin(edges.front()), -std::sin(edges.back()));
  return std::max(
      0, std::min(static_cast<int>(std::ceil((farthest - end) / spacing)), static_cast<int>(room / spacing)));
}

std::vector<double> fine_beam_edges(const Aperture& aperture) {
  const std::vector<double>& edges = aperture.beam_edges_rad;
  const int beyond = fine_beams_beyond(aperture);
  const double spacing = (std::sin(edges.front()) - std::sin(edges.back())) /
                         static_cast<double>(edges.size() - 1) / aperture.fine_beams;
  std::vector<double> fine;
  for (int i = beyond; i > 0; --i) {
    fine.push_back(std::asin(std::sin(edges.front()) + i * spacing));
  }
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    const double port = std::sin(edges[beam]);
    const double starboard = std::sin(edges[beam + 1]);
    fine.push_back(edges[beam]);
    for (int i = 1; i < aperture.fine_beams; ++i) {
      fine.push_back(std::asin(port + (starboard - port) * i / aperture.fine_beams));
    }
  }
  fine.push_back(edges.back());
  for (int i = 1; i <= beyond; ++i) {
    fine.push_back(std::asin(std::sin(edges.back()) - i * spacing));
  }
  return fine;
}

BeamPattern::BeamPattern(const Aperture& aperture, RandomKey elements)
    : fine_per_beam_(aperture.fine_beams), beyond_(fine_beams_beyond(aperture)) {
  const PatternTable table(aperture, elements);
  leaks_ = table.floor() > 0;
  const std::vector<double> edges = fine_beam_edges(aperture);
  std::vector<double> sines;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    sines.push_back(std::sin(edges[i]));
    if (i > 0) {
      inverse_width_.push_back(static_cast<float>(1 / (edges[i - 1] - edges[i])));
    }
  }
  for (int beam = 0; beam < aperture.beam_count(); ++beam) {
    add_band(aperture, beam, sines, table);
  }
}

void BeamPattern::add_band(const Aperture& aperture, int beam, const std::vector<double>& sines,
                           const PatternTable& table) {
  const auto b = static_cast<std::size_t>(beam);
  const double port_rad = aperture.beam_edges_rad[b];
  const double starboard_rad = aperture.beam_edges_rad[b + 1];
  const double axis = (std::sin(port_rad) + std::sin(starboard_rad)) / 2;
  const auto fine_beams = static_cast<std::size_t>(this->fine_beams());
  // This beam receives c_b * `received` of an echo that is even in angle.
  double received = 0;
  std::vector<double> over_floor(fine_beams);
  std::size_t first = fine_beams;
  std::size_t last = 0;
  for (std::size_t f = 0; f < fine_beams; ++f) {
    over_floor[f] = table.excess(sines[f + 1] - axis, sines[f] - axis);
    received += (over_floor[f] + table.floor()) / static_cast<double>(inverse_width_[f]);
    if (over_floor[f] != 0) {
      first = std::min(first, f);
      last = f;
    }
  }
  const double scale = (port_rad - starboard_rad) / received;
  bands_.push_back({static_cast<int>(first), static_cast<int>(last - first + 1), weights_.size(),
                    static_cast<float>(scale * table.floor())});
  for (std::size_t f = first; f <= last; ++f) {
    weights_.push_back(static_cast<float>(scale * over_floor[f]));
  }
  const int first_of_beam = beyond_ + beam * fine_per_beam_;
  double change = 0;
  for (int f = 0; f < this->fine_beams(); ++f) {
    change +=
        std::abs(share(beam, f) - (f >= first_of_beam && f < first_of_beam + fine_per_beam_ ? 1.0 : 0.0));
  }
  change_ = std::max(change_, change);
}

double BeamPattern::share(int beam, int fine_beam) const {
  const Band& band = bands_[static_cast<std::size_t>(beam)];
  const int at = fine_beam - band.first;
  const float in_band =
      at >= 0 && at < band.count ? weights_[band.weights + static_cast<std::size_t>(at)] : 0.0F;
  return static_cast<double>(in_band) + static_cast<double>(band.leak);
}

BeamPattern::Beams BeamPattern::receivers_of(int first_fine_beam, int last_fine_beam) const {
  Beams beams;
  for (int b = 0; b < static_cast<int>(bands_.size()); ++b) {
    const Band& band = bands_[static_cast<std::size_t>(b)];
    if (first_fine_beam < band.first + band.count && last_fine_beam >= band.first) {
      beams = {beams.end == 0 ? b : beams.begin, b + 1};
    }
  }
  return beams;
}

void BeamPattern::add_lobe(int fine_beam, float echo, const Beams& of, std::vector<float>& beams) const {
  for (int beam = of.begin; beam < of.end; ++beam) {
    const auto b = static_cast<std::size_t>(beam);
    const int at = fine_beam - bands_[b].first;
    if (at >= 0 && at < bands_[b].count) {
      beams[b] += echo * weights_[bands_[b].weights + static_cast<std::size_t>(at)];
    }
  }
}

BeamPattern::LineSums BeamPattern::sum_lines(const EchoImage& fine, WorkerPool& workers) const {
  constexpr int lines_per_job = 256;
  const auto lines = static_cast<std::size_t>(fine.bins);
  LineSums sums;
  sums.sum.resize(lines);
  sums.least.resize(lines, std::numeric_limits<float>::max());
  sums.most.resize(lines);
  workers.run((fine.bins + lines_per_job - 1) / lines_per_job, [&](int job) {
    const auto begin = static_cast<std::size_t>(job * lines_per_job);
    const int count = std::min(lines_per_job, fine.bins - job * lines_per_job);
    for (std::size_t f = 0; f < inverse_width_.size(); ++f) {
      gather_row(&fine.intensity[f * lines + begin], inverse_width_[f], count, &sums.sum[begin],
                 &sums.least[begin], &sums.most[begin]);
    }
  });
  return sums;
}

std::vector<BeamPattern::Span> BeamPattern::spans_of(const LineSums& sums, int lines,
                                                     const SkipSwitches& skip, SkipCounts& skipped) const {
  std::vector<Span> spans;
  for (int begin = 0; begin < lines; begin += lines_per_tile) {
    const int end = std::min(lines, begin + lines_per_tile);
    bool even = skip.on(SkipRule::even_bins);
    for (int k = begin; even && k < end; ++k) {
      const auto line = static_cast<std::size_t>(k);
      even = sums.most[line] - sums.least[line] <= linearity * sums.most[line];
    }
    if (even) {
      skipped.add(SkipRule::even_bins, static_cast<std::uint64_t>(end - begin));
    }
    if (spans.empty() || spans.back().even != even) {
      spans.push_back({begin, end, even});
    }
    spans.back().end = end;
  }
  return spans;
}

void BeamPattern::receive(const EchoImage& fine, int beam, const Span& span, const float* leaks,
                          float* out) const {
  const auto lines = static_cast<std::size_t>(fine.bins);
  const int count = span.end - span.begin;
  const auto row = [&](int f) {
    return &fine.intensity[static_cast<std::size_t>(f) * lines + static_cast<std::size_t>(span.begin)];
  };
  if (span.even) {
    const int first = beyond_ + beam * fine_per_beam_;
    set_row(row(first), 1.0F, count, out);
    for (int f = 1; f < fine_per_beam_; ++f) {
      add_row(row(first + f), 1.0F, count, out);
    }
    return;
  }
  const Band& band = bands_[static_cast<std::size_t>(beam)];
  if (leaks != nullptr) {
    set_row(leaks + span.begin, band.leak, count, out);
  } else {
    std::fill_n(out, count, 0.0F);
  }
  int f = 0;
  for (; f + rows_per_pass <= band.count; f += rows_per_pass) {
    add_four_rows(row(band.first + f), lines, &weights_[band.weights + static_cast<std::size_t>(f)], count,
                  out);
  }
  for (; f < band.count; ++f) {
    add_row(row(band.first + f), weights_[band.weights + static_cast<std::size_t>(f)], count, out);
  }
}

void BeamPattern::apply(const EchoImage& fine, EchoImage& out, WorkerPool& workers, const SkipSwitches& skip,
                        SkipCounts& skipped) const {
  constexpr int beams_per_job = 8;  // neighbours read the same rows
  out.beams = static_cast<int>(bands_.size());
  out.bins = fine.bins;
  out.intensity.resize(bands_.size() * static_cast<std::size_t>(fine.bins));
  const LineSums sums = sum_lines(fine, workers);
  const std::vector<Span> spans = spans_of(sums, fine.bins, skip, skipped);
  const bool no_leak = !leaks_ && skip.on(SkipRule::perfect_elements);
  skipped.add(SkipRule::perfect_elements, no_leak ? 1 : 0);
  workers.run((out.beams + beams_per_job - 1) / beams_per_job, [&](int job) {
    const int end = std::min(out.beams, (job + 1) * beams_per_job);
    for (int beam = job * beams_per_job; beam < end; ++beam) {
      float* const row = &out.intensity[static_cast<std::size_t>(beam) * static_cast<std::size_t>(fine.bins)];
      for (const Span& span : spans) {
        receive(fine, beam, span, no_leak ? nullptr : sums.sum.data(), row + span.begin);
      }
    }
  });
}

}  // namespace sonard::render
