#include "renderer/visibility/grid_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/binning/range_plane.hpp"

namespace sonard::render {

namespace {

constexpr double most_samples = 0x1p25;  // half a GiB of them
constexpr int most_pixels = 8192;        // of a view in each direction; every OpenGL 4.5 can draw 16384
constexpr int most_columns_per_beam = 32;

// Measured on the scenes of the benchmark (docs/accuracy.md): the error falls with about the 0.6th power of
// the number of samples, and is hardly ever more than this share of the distance to the image of a quarter of
// the samples.
constexpr double order = 0.6;
constexpr double error_of_distance = 0.4;
constexpr double longest_stride = 4;  // one odd bin shall not cost more than 16 times the samples

constexpr double heard = 1e-2;  // of the beam's maximum: what errors are taken over

int columns_per_beam(int step) {
  return 1 << ((step + 1) / 2);
}

/// At the coarsest: a row for every 0.16 degrees of elevation.
int least_rows(const Aperture& aperture) {
  constexpr double row_rad = std::numbers::pi / 9 / 128;
  return std::max(16, static_cast<int>(std::lround(2 * aperture.elevation_limit_rad() / row_rad)));
}

/// Of every view, at one column a beam.
int columns_of_view(const Aperture& aperture, int views) {
  return (aperture.beam_count() + views - 1) / views;
}

}  // namespace

GridLadder::GridLadder(const Aperture& aperture) : aperture_(aperture) {
  check_aperture(aperture);
  const double width_rad = aperture.beam_edges_rad.front() - aperture.beam_edges_rad.back();
  const int columns = most_columns_per_beam * aperture.beam_count();
  views_ = std::max(static_cast<int>(std::ceil(width_rad / widest_view_rad - 1e-9)),
                    (columns + most_pixels - 1) / most_pixels);
  while (last_step_ + 1 < step_count) {
    const Sampling finer = sampling(last_step_ + 1);
    if (1.0 * finer.views * finer.columns_per_view * finer.rows > most_samples || finer.rows > most_pixels) {
      break;
    }
    ++last_step_;
  }
}

Sampling GridLadder::sampling(int step) const {
  return Sampling::of_grid(views_, columns_of_view(aperture_, views_) * columns_per_beam(step),
                           least_rows(aperture_) << (step / 2));
}

int GridLadder::first_step(Sampling::Preset preset) const {
  switch (preset) {
    case Sampling::Preset::fast:
      return least_step;
    case Sampling::Preset::reference:
      return last_step_;
    default:
      return std::min(least_step + 2, last_step_);
  }
}

const SampleGrid& GridLadder::grid(int step) {
  std::unique_ptr<const SampleGrid>& grid = grids_[static_cast<std::size_t>(step)];
  if (!grid) {
    grid = std::make_unique<const SampleGrid>(make_sample_grid(aperture_, sampling(step)));
  }
  return *grid;
}

double target_error(Sampling::Preset preset) {
  return preset == Sampling::Preset::fast ? 0.05 : 0.01;
}

ThinnedSamples::ThinnedSamples(const SampleGrid& fine, const std::vector<const SurfaceSample*>& samples,
                               const SampleGrid& coarse) {
  for (std::size_t v = 0; v < coarse.views.size(); ++v) {
    const SubView& from = fine.views[v];
    const SubView& to = coarse.views[v];
    std::vector<SurfaceSample> thinned;
    thinned.reserve(static_cast<std::size_t>(to.columns) * static_cast<std::size_t>(to.rows));
    const auto half_width = static_cast<float>(from.pixel_width() / 2);
    const auto half_height = static_cast<float>(from.pixel_height() / 2);
    for (int j = 0; j < to.rows; ++j) {
      const SurfaceSample* row = samples[v] + 2 * static_cast<std::ptrdiff_t>(j) * from.columns;
      const auto y = static_cast<float>(-from.tan_half_height + (2 * j + 0.5) * from.pixel_height());
      for (int i = 0; i < to.columns; ++i) {
        SurfaceSample sample = row[2 * static_cast<std::ptrdiff_t>(i)];
        if (sample.range_m > 0) {
          const auto x = static_cast<float>(-from.tan_half_width + (2 * i + 0.5) * from.pixel_width());
          RangePlane plane{sample.range_m, sample.range_dx, sample.range_dy};
          plane.move(x, y, half_width, half_height);
          sample = {plane.range, sample.response, plane.dx, plane.dy};
        }
        thinned.push_back(sample);
      }
    }
    views_.push_back(std::move(thinned));
  }
}

std::vector<const SurfaceSample*> ThinnedSamples::views() const {
  std::vector<const SurfaceSample*> views;
  for (const std::vector<SurfaceSample>& view : views_) {
    views.push_back(view.data());
  }
  return views;
}

double estimate_error(const BinningResult& image, const BinningResult& thinned,
                      const std::vector<float>& line_weight) {
  const auto lines = static_cast<std::size_t>(image.lines);
  double squares = 0;
  double bins = 0;
  for (std::size_t begin = 0; begin < image.echo.size(); begin += lines) {
    const auto echo = [&](std::size_t k) {
      return image.echo[begin + k] * (line_weight.empty() ? 1.0F : line_weight[k]);
    };
    float strongest = 0.0F;
    for (std::size_t k = 0; k < lines; ++k) {
      strongest = std::max(strongest, echo(k));
    }
    for (std::size_t k = 0; k < lines; ++k) {
      if (echo(k) > static_cast<float>(heard) * strongest) {
        const auto off = static_cast<double>(thinned.echo[begin + k] / image.echo[begin + k] - 1);
        squares += off * off;
        bins += 1;
      }
    }
  }
  return bins > 0 ? error_of_distance * std::sqrt(squares / bins) : 0.0;
}

int next_step(const GridLadder& ladder, int step, double error, double target) {
  if (error <= target) {
    return step;
  }
  const double more = std::min(std::ceil(std::log2(error / target) / order), longest_stride);
  return std::min(step + static_cast<int>(more), ladder.last_step());
}

}  // namespace sonard::render
