// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/echo.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::ping1d {
namespace {

constexpr float least_peak = 2.0F / 255.0F;
constexpr float stands_out = 3.0F;      // over the noise
constexpr float end_of_echo = 0.25F;    // share of the peak below which an echo ends
constexpr float onset = 0.2F;           // share of the peak of the first sample of an echo
constexpr float onset_in_noise = 3.0F;  // the same, over the noise

/// Root mean square of samples [first, end), each clipped at full scale.
float rms(std::span<const float> samples, std::size_t first, std::size_t end) {
  float sum = 0.0F;
  for (std::size_t k = first; k < end; ++k) {
    const float clipped = std::min(1.0F, samples[k]);
    sum += clipped * clipped;
  }
  return std::sqrt(sum / static_cast<float>(end - first));
}

/// The scan, divided into points of samples.
class Points {
 public:
  Points(std::span<const float> samples, const Scan& scan, int points)
      : samples_(samples),
        first_mm_(scan.start_mm),
        point_mm_(static_cast<double>(scan.length_mm) / points),
        step_mm_(samples_of(scan, points).step_mm) {
    for (int i = 0; i < points; ++i) {
      strength_.push_back(rms(samples, first_sample(i), end_sample(i)));
    }
  }

  std::size_t first_sample(int point) const {
    return std::min(at(first_mm_ + point * point_mm_), samples_.size() - 1);
  }
  std::size_t end_sample(int point) const {
    return std::clamp(at(first_mm_ + (point + 1) * point_mm_), first_sample(point) + 1, samples_.size());
  }
  const std::vector<float>& strength() const { return strength_; }
  /// The first point that begins at this range or beyond.
  int first_beyond(double range_mm) const {
    return static_cast<int>(std::max(0.0, std::ceil((range_mm - first_mm_) / point_mm_)));
  }

  /// Where the echo begins that reaches `level` between the points `first` and `last`, within a sample: the
  /// share of its first sample that a bed fills is the share of its energy.
  std::optional<double> begin_mm(int first, int last, float level) const {
    const std::size_t end = end_sample(last);
    std::size_t k = first_sample(first);
    while (k < end && samples_[k] < level) {
      ++k;
    }
    if (k == end) {
      return std::nullopt;
    }
    const auto energy = [&](std::size_t i) { return i < samples_.size() ? samples_[i] * samples_[i] : 0.0F; };
    if (energy(k + 1) < energy(k) / 4.0F) {
      return (static_cast<double>(k) + 0.5) * step_mm_;  // a single point, anywhere in its sample
    }
    const float full = std::max(energy(k), 2.0F * energy(k + 1) - energy(k + 2));
    return (static_cast<double>(k + 1) - energy(k) / full) * step_mm_;
  }

 private:
  std::size_t at(double range_mm) const { return static_cast<std::size_t>(range_mm / step_mm_ + 1e-6); }

  std::span<const float> samples_;
  double first_mm_, point_mm_, step_mm_;
  std::vector<float> strength_;
};

/// The points [first, end) of the echo around `peak`.
struct Extent {
  int first, end;
};
Extent extent_of(std::span<const float> strength, int least, int peak, float level) {
  Extent echo{peak, peak + 1};
  while (echo.first > least && strength[static_cast<std::size_t>(echo.first - 1)] >= level) {
    --echo.first;
  }
  while (echo.end < static_cast<int>(strength.size()) &&
         strength[static_cast<std::size_t>(echo.end)] >= level) {
    ++echo.end;
  }
  return echo;
}

/// The noise, even if an echo fills half of the scan.
float lower_quartile(std::vector<float> values) {
  const auto quarter = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quarter, values.end());
  return *quarter;
}

}  // namespace

std::vector<float> amplitudes(const PingImage& image) {
  std::vector<float> found;
  found.reserve(image.u8.size() + image.u16.size());
  std::ranges::transform(image.u8, std::back_inserter(found), [](auto code) { return code / 255.0F; });
  static_assert(image_exponent == 0.25);
  std::ranges::transform(image.u16, std::back_inserter(found), [](auto code) {
    const float root = (code + 0.5F) / 65535.0F;  // codes are rounded down
    return static_cast<float>(image_full_scale) * (root * root) * (root * root);
  });
  return found;
}

Echo find_echo(std::span<const float> amplitudes, const Scan& scan, int points, double least_range_mm) {
  const Points all(amplitudes, scan, points);
  const std::vector<float>& strength = all.strength();
  Echo echo;
  std::ranges::transform(strength, std::back_inserter(echo.profile), [](float point) {
    return static_cast<std::uint8_t>(std::min(255.0F, std::round(255.0F * point)));
  });
  const int least = all.first_beyond(least_range_mm);
  if (least >= points) {
    return echo;
  }
  const auto from = strength.begin() + least;
  const auto strongest = std::max_element(from, strength.end());
  echo.peak = *std::max_element(echo.profile.begin() + least, echo.profile.end());
  echo.saturated = static_cast<int>(std::count(echo.profile.begin() + least, echo.profile.end(), 255));
  const float floor = lower_quartile({from, strength.end()});
  if (*strongest < least_peak || *strongest < stands_out * floor) {
    return echo;
  }
  const int peak = static_cast<int>(strongest - strength.begin());
  const Extent extent = extent_of(strength, least, peak, std::max(end_of_echo * *strongest, 2.0F * floor));
  echo.distance_mm = all.begin_mm(std::max(least, extent.first - 1), peak,
                                  std::max(onset * *strongest, onset_in_noise * floor));
  float second = 0.0F;
  for (int i = least; i < points; ++i) {
    second = i < extent.first || i >= extent.end ? std::max(second, strength[static_cast<std::size_t>(i)])
                                                 : second;
  }
  echo.confidence_percent = 100.0 * (1.0 - second / *strongest);
  return echo;
}

}  // namespace sonard::ping1d
