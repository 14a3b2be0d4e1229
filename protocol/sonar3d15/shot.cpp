// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/shot.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <variant>

#include <fmt/format.h>

#include "protocol/sonar3d15/imu.hpp"
#include "protocol/sonar3d15/recording.hpp"

namespace sonard::sonar3d15 {
namespace {

using std::chrono::nanoseconds;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double least_strength = 30.0;    // of a signal byte
constexpr double most_strength = 32767.0;  // 15 bits
constexpr double most_code = 65535.0;

template <class Image>
void set_common(const Image& from, BitmapImageGreyscale8& to) {
  to.set_speed_of_sound(from.speed_of_sound());
  to.set_range(from.range());
  to.set_frequency(from.frequency());
  to.set_width(from.width());
  to.set_height(from.height());
  to.set_fov_horizontal(from.fov_horizontal());
  to.set_fov_vertical(from.fov_vertical());
}

/// Pixel of an echo; 0 if it cannot be sent. @param range_m as the head measures it
std::uint32_t range_code(double range_m, double step_m, double scale_m) {
  // The small part keeps a range that is a whole number of steps from falling below it by rounding.
  const double code = std::floor(std::floor(range_m / step_m + 1e-6) * step_m / scale_m);
  return code <= most_code ? static_cast<std::uint32_t>(code) : 0;
}

char signal_code(double strength) {
  const double code = std::floor(100.0 * std::log10(std::min(strength, most_strength) / least_strength));
  return static_cast<char>(static_cast<std::uint8_t>(std::clamp(code, 1.0, 255.0)));
}

/// How fast the range changes with the angle from pixel to pixel, over the range: the tangent of the angle
/// at which the surface leans. 0 beside pixels without an echo.
double lean(const RangeImage& image, int before, int after, double angle_rad) {
  const double near_m = distance_m(image, before), far_m = distance_m(image, after);
  return near_m > 0.0 && far_m > 0.0 ? 2.0 * (far_m - near_m) / ((far_m + near_m) * angle_rad) : 0.0;
}

char shade_of(const RangeImage& image, int row, int column) {
  const auto columns = static_cast<int>(image.width()), rows = static_cast<int>(image.height());
  const int left = std::max(column - 1, 0), right = std::min(column + 1, columns - 1);
  const int below = std::max(row - 1, 0), above = std::min(row + 1, rows - 1);
  const double across = lean(image, row * columns + left, row * columns + right,
                             column_rad(image, right) - column_rad(image, left));
  const double along = lean(image, below * columns + column, above * columns + column,
                            row_rad(image, above) - row_rad(image, below));
  const double facing = 1.0 / std::sqrt(1.0 + across * across + along * along);
  return static_cast<char>(static_cast<std::uint8_t>(std::max(1.0, std::round(255.0 * facing))));
}

nanoseconds seconds(double value) {
  return std::chrono::duration_cast<nanoseconds>(std::chrono::duration<double>(value));
}

}  // namespace

PingJob make_job(const DeviceConfig& config, const Settings& settings, double sound_speed_mps) {
  const ModeConfig& mode = config.mode(settings.high_frequency);
  const double true_per_measured = config.water_sound_speed_mps / sound_speed_mps;
  PingJob job;
  job.native_bin_m = config.range_bin_m;
  job.native_bins =
      std::max(1, static_cast<int>(std::ceil(settings.range_m * true_per_measured / job.native_bin_m)));
  job.listening_time = seconds(2.0 * settings.range_m / sound_speed_mps);
  job.period = std::max(seconds(config.time_scale / mode.rate_hz), job.listening_time);
  job.mode = settings.high_frequency ? 1 : 0;
  job.directions = {.columns = config.columns,
                    .rows = config.rows,
                    .horizontal_fov_rad = mode.horizontal_fov_deg * degree,
                    .vertical_fov_rad = mode.vertical_fov_deg * degree,
                    .nearest_m = settings.least_range_m * true_per_measured};
  job.sound_speed_mps = config.water_sound_speed_mps;
  job.frequency_hz = mode.carrier_hz;
  job.settings = {{"mode", settings.high_frequency ? "high-frequency" : "low-frequency"},
                  {"range", fmt::format("{:.2f}m", settings.range_m)},
                  {"sound_speed", fmt::format("{:.1f}m/s", sound_speed_mps)}};
  return job;
}

Shot make_shot(const DeviceConfig& config, const Settings& settings, double sound_speed_mps) {
  const ModeConfig& mode = config.mode(settings.high_frequency);
  Shot shot;
  RangeImage& range = shot.range;
  range.set_speed_of_sound(static_cast<float>(sound_speed_mps));
  range.set_range(static_cast<float>(settings.range_m));
  range.set_frequency(mode.frequency_field);
  range.set_width(static_cast<std::uint32_t>(config.columns));
  range.set_height(static_cast<std::uint32_t>(config.rows));
  range.set_fov_horizontal(static_cast<float>(mode.horizontal_fov_deg));
  range.set_fov_vertical(static_cast<float>(mode.vertical_fov_deg));
  range.set_image_pixel_scale(static_cast<float>(config.pixel_scale_m));
  set_common(range, shot.signal);
  return shot;
}

bool add_echoes(const DirectionRanges& echoes, const DeviceConfig& config, double least_range_m, Shot& shot) {
  const std::size_t pixels = std::size_t{shot.range.width()} * shot.range.height();
  if (echoes.range_m.size() != pixels || echoes.intensity.size() != pixels) {
    return false;
  }
  const auto speed_mps = static_cast<double>(shot.range.speed_of_sound());
  const auto most_m = static_cast<double>(shot.range.range());
  const double measured_per_true = speed_mps / config.water_sound_speed_mps;
  auto& ranges = *shot.range.mutable_image_pixel_data();
  std::string& signals = *shot.signal.mutable_image_pixel_data();
  ranges.Resize(static_cast<int>(pixels), 0);
  signals.assign(pixels, '\0');
  for (std::size_t i = 0; i < pixels; ++i) {
    const double range_m = static_cast<double>(echoes.range_m[i]) * measured_per_true;
    const double strength = config.gain * std::sqrt(static_cast<double>(echoes.intensity[i]));
    if (range_m > 0.0 && range_m >= least_range_m && range_m <= most_m && strength > config.threshold) {
      const std::uint32_t code = range_code(range_m, speed_mps * config.range_step_s, config.pixel_scale_m);
      ranges[static_cast<int>(i)] = code;
      signals[i] = code > 0 ? signal_code(strength) : '\0';
    }
  }
  return true;
}

void set_header(std::chrono::nanoseconds utc, std::uint32_t sequence, Shot& shot) {
  Header& header = *shot.range.mutable_header();
  *header.mutable_timestamp() = timestamp_of(utc);
  header.set_sequence_id(sequence);
  *shot.signal.mutable_header() = header;
}

double distance_m(const RangeImage& image, int pixel) {
  return image.image_pixel_data(pixel) * static_cast<double>(image.image_pixel_scale());
}

double column_rad(const RangeImage& image, int column) {
  const double fov = static_cast<double>(image.fov_horizontal()) * degree;
  return column * fov / (image.width() - 1) - fov / 2;
}

double row_rad(const RangeImage& image, int row) {
  const double fov = static_cast<double>(image.fov_vertical()) * degree;
  return row * fov / (image.height() - 1) - fov / 2;
}

BitmapImageGreyscale8 shaded(const Shot& shot) {
  const auto columns = static_cast<int>(shot.range.width()), rows = static_cast<int>(shot.range.height());
  BitmapImageGreyscale8 image = shot.signal;
  image.set_type(waterlinked::sonar::protocol::SHADED_IMAGE);
  std::string& pixels = *image.mutable_image_pixel_data();
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      char& pixel = pixels[static_cast<std::size_t>(row * columns + column)];
      pixel = pixel == 0 ? pixel : shade_of(shot.range, row, column);
    }
  }
  return image;
}

PingRecord record_of(const Shot& shot, double carrier_hz, std::vector<std::uint8_t> wire) {
  const RangeImage& range = shot.range;
  const auto columns = static_cast<int>(range.width());
  PingRecord record;
  record.settings = {.bins = fan_bins,
                     .beams = columns,
                     .bin_m = static_cast<double>(range.range()) / fan_bins,
                     .sound_speed_mps = static_cast<double>(range.speed_of_sound()),
                     .frequency_hz = carrier_hz};
  for (int column = 0; column < columns; ++column) {
    record.bearings_rad.push_back(column_rad(range, column));
  }
  record.sector_rad = static_cast<double>(range.fov_horizontal()) * degree;
  record.samples.resize(static_cast<std::size_t>(fan_bins) * range.width());
  std::vector<EchoPoint>& points = record.points.emplace();
  for (int pixel = 0; pixel < range.image_pixel_data_size(); ++pixel) {
    const int bin =
        std::min(static_cast<int>(distance_m(range, pixel) / record.settings.bin_m), fan_bins - 1);
    const double range_m = distance_m(range, pixel), bearing_rad = column_rad(range, pixel % columns),
                 elevation_rad = row_rad(range, pixel / columns);
    if (range_m > 0.0) {
      const double level_m = range_m * std::cos(elevation_rad);
      const char code = shot.signal.image_pixel_data()[static_cast<std::size_t>(pixel)];
      points.push_back({static_cast<float>(level_m * std::cos(bearing_rad)),
                        static_cast<float>(-level_m * std::sin(bearing_rad)),
                        static_cast<float>(range_m * std::sin(elevation_rad)),
                        static_cast<float>(static_cast<std::uint8_t>(code))});
    }
    std::uint8_t& sample = record.samples[static_cast<std::size_t>(bin * columns + pixel % columns)];
    sample = std::max(
        sample, static_cast<std::uint8_t>(shot.signal.image_pixel_data()[static_cast<std::size_t>(pixel)]));
  }
  record.wire = std::move(wire);
  return record;
}

std::optional<Shot> recorded_form(std::span<const std::uint8_t> wire) {
  Shot shot;
  int packets = 0;
  bool readable = true;
  const auto damages = for_each_packet(wire, [&](std::span<const std::uint8_t> packet) {
    const auto message = decode(packet);
    const auto* const range = message ? std::get_if<RangeImage>(&*message) : nullptr;
    const auto* const signal = message ? std::get_if<BitmapImageGreyscale8>(&*message) : nullptr;
    readable = readable && (packets == 0 ? range != nullptr : packets == 1 && signal != nullptr);
    if (range != nullptr) {
      shot.range = *range;
    } else if (signal != nullptr) {
      shot.signal = *signal;
    }
    ++packets;
  });
  const RangeImage& range = shot.range;
  const bool possible = range.width() >= 2 && range.height() >= 2 && shot.signal.width() == range.width() &&
                        shot.signal.height() == range.height() && range.range() > 0.0F &&
                        range.range() < 1000.0F && range.speed_of_sound() >= 100.0F &&
                        range.speed_of_sound() < 1e5F;
  return damages.empty() && readable && packets == 2 && possible ? std::optional(shot) : std::nullopt;
}

std::vector<Difference> differences(const Shot& asked, const Shot& recorded) {
  std::vector<Difference> found;
  const auto compare = [&found](const char* kind, const char* text, float want, float have) {
    if (std::abs(want - have) > 0.005F) {
      found.push_back({kind, fmt::format(fmt::runtime(text), want, have)});
    }
  };
  compare("range", "range {:.2f} m requested, {:.2f} m sent", asked.range.range(), recorded.range.range());
  compare("mode", "field of view {:.0f} degrees requested, {:.0f} sent", asked.range.fov_horizontal(),
          recorded.range.fov_horizontal());
  if (asked.range.speed_of_sound() > 0.0F) {
    compare("sound_speed", "sound speed {:.1f} m/s requested, {:.1f} m/s sent", asked.range.speed_of_sound(),
            recorded.range.speed_of_sound());
  }
  return found;
}

}  // namespace sonard::sonar3d15
