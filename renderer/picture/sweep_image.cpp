// SPDX-License-Identifier: Apache-2.0
#include "renderer/picture/sweep_image.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "renderer/picture/amber.hpp"
#include "renderer/picture/polar_grid.hpp"

namespace sonard::picture {
namespace {

constexpr int bearing_ahead = 3200;
/// Half units: the edges of a step are multiples of it, even if the step is odd.
constexpr int slots_per_turn = 2 * units_per_turn;
constexpr double slot_rad = 2.0 * std::numbers::pi / slots_per_turn;

int slot_of(double bearing_rad) {
  const int slot = static_cast<int>(std::floor(bearing_rad / slot_rad)) + 2 * bearing_ahead;
  return (slot + slots_per_turn) % slots_per_turn;
}

SectorGeometry geometry_of(const SweepShape& shape, const FanStyle& style) {
  const int margin_px = style.grid ? grid_margin_px : 0;
  if (shape.full_circle()) {
    return {shape.range_m(), -std::numbers::pi, std::numbers::pi, style.radius_px, margin_px};
  }
  const int port_slot = 2 * (shape.left - bearing_ahead) - shape.step;
  // Port edges beyond astern wrap around by a full turn.
  const double port_rad =
      (port_slot < -slots_per_turn / 2 ? port_slot + slots_per_turn : port_slot) * slot_rad;
  return {shape.range_m(), port_rad, port_rad + 2 * (shape.width + shape.step) * slot_rad, style.radius_px,
          margin_px};
}

/// Index of the visible line in each slot; -1: no line.
std::vector<int> lines_in_slots(const std::vector<SweepLine>& lines, int step) {
  std::vector<int> seen(slots_per_turn, -1);
  for (std::size_t line = 0; line < lines.size(); ++line) {
    for (int slot = 2 * lines[line].bearing - step; slot < 2 * lines[line].bearing + step; ++slot) {
      seen[static_cast<std::size_t>((slot + slots_per_turn) % slots_per_turn)] = static_cast<int>(line);
    }
  }
  return seen;
}

/// One row per line, one column per bin. Lines of another length are cut or padded with 0.
cv::Mat matrix_of(const std::vector<SweepLine>& lines, int bins) {
  cv::Mat rows = cv::Mat::zeros(static_cast<int>(lines.size()), bins, CV_8UC1);
  for (std::size_t line = 0; line < lines.size(); ++line) {
    const auto& samples = lines[line].samples;
    std::copy_n(samples.begin(), std::min(samples.size(), static_cast<std::size_t>(bins)),
                rows.ptr<uchar>(static_cast<int>(line)));
  }
  return rows;
}

}  // namespace

int turn_bearing(double bearing_rad) {
  const double turn_rad = std::remainder(bearing_rad, 2.0 * std::numbers::pi);
  const int units = static_cast<int>(std::lround(turn_rad * units_per_turn / (2.0 * std::numbers::pi)));
  return (bearing_ahead + units + units_per_turn) % units_per_turn;
}

int turn_units(double angle_rad) {
  return std::max(1, static_cast<int>(std::lround(angle_rad * units_per_turn / (2.0 * std::numbers::pi))));
}

SweepImage::SweepImage(const SweepShape& shape, const FanStyle& style)
    : shape_(shape),
      geometry_(geometry_of(shape, style)),
      style_(style),
      mapped_bins_(std::min(shape.bins, style.radius_px)) {
  map_pixels();
  if (style.grid) {
    grid_ = polar_grid(geometry_, round_bearings_deg(geometry_));
  }
}

void SweepImage::map_pixels() {
  const cv::Size size = geometry_.size();
  map_bins_.create(size, CV_32FC1);
  slots_.create(size, CV_32SC1);
  const double bins_per_metre = mapped_bins_ / shape_.range_m();
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const cv::Point2d pixel(x, y);
      const double range_m = geometry_.range_at(pixel);
      const double bearing_rad = geometry_.bearing_at(pixel);
      const bool inside = range_m < geometry_.range_m() && geometry_.contains(bearing_rad);
      slots_.at<int>(y, x) = inside ? slot_of(bearing_rad) : -1;
      // The centre of bin k is at k + 0.5 bins.
      map_bins_.at<float>(y, x) = inside ? static_cast<float>(range_m * bins_per_metre - 0.5) : 0.0F;
    }
  }
}

SweepImage::Projection SweepImage::project(const std::vector<SweepLine>& lines, Resampling resampling) const {
  const cv::Size size = geometry_.size();
  Projection projection{cv::Mat::zeros(size, CV_8UC1), cv::Mat::zeros(size, CV_8UC1)};
  if (lines.empty()) {
    return projection;
  }
  cv::Mat source = matrix_of(lines, shape_.bins);
  const bool smooth = resampling == Resampling::smooth;
  if (smooth && mapped_bins_ < source.cols) {
    cv::resize(source, source, {mapped_bins_, source.rows}, 0.0, 0.0, cv::INTER_AREA);
  }
  const std::vector<int> seen = lines_in_slots(lines, shape_.step);
  cv::Mat map_lines = cv::Mat::zeros(size, CV_32FC1);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int slot = slots_.at<int>(y, x);
      const int line = slot >= 0 ? seen[static_cast<std::size_t>(slot)] : -1;
      if (line >= 0) {
        projection.covered.at<uchar>(y, x) = 255;
        map_lines.at<float>(y, x) = static_cast<float>(line);
      }
    }
  }
  cv::Mat samples;
  cv::remap(source, samples, smooth ? map_bins_ : finer(map_bins_, shape_.bins, mapped_bins_), map_lines,
            smooth ? cv::INTER_LINEAR : cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  samples.copyTo(projection.samples, projection.covered);
  return projection;
}

cv::Mat SweepImage::draw(const std::vector<SweepLine>& lines, const std::string& caption) const {
  const Projection projection = project(lines);
  cv::Mat picture = amber::paint(projection.samples, amber::Samples::decibels, projection.covered);
  if (style_.grid) {
    add_grid(picture, grid_, caption);
  }
  return picture;
}

cv::Mat sweep_polar_image(const SweepShape& shape, const std::vector<SweepLine>& lines) {
  const bool all_round = shape.width == units_per_turn;
  const int steps = (shape.width + shape.step - 1) / shape.step;
  const int columns = all_round ? steps : steps + 1;
  const cv::Mat rows = matrix_of(lines, shape.bins);
  cv::Mat polar = cv::Mat::zeros(shape.bins, columns, CV_8UC1);
  for (int line = 0; line < rows.rows; ++line) {
    const int offset =
        (lines[static_cast<std::size_t>(line)].bearing - shape.left + units_per_turn) % units_per_turn;
    const int column = (2 * offset + shape.step) / (2 * shape.step);
    if (all_round || column < columns) {
      cv::Mat(rows.row(line).t()).copyTo(polar.col(column % columns));
    }
  }
  return raw_polar_image(polar);
}

}  // namespace sonard::picture
