// SPDX-License-Identifier: Apache-2.0
// Distribution and correlation of an even echo and of noise.
#include <functional>

#include "tests/realism/rows.hpp"
#include "tests/realism/statistics.hpp"
#include "tests/support/correlation.hpp"
#include "tests/support/gemini_client.hpp"

namespace sonard::realism {
namespace {

using test::GeminiImage;

/// Only beams below this are used, to avoid the stripe at broadside.
constexpr int end_beam = 110;

/// Codes of the lines from one range to another, beam after beam.
std::vector<double> codes_of(const GeminiImage& image, double from_m, double to_m, int lag_lines = 0,
                             int lag_beams = 0) {
  std::vector<double> codes;
  for (int line = static_cast<int>(from_m / image.line_m); line < static_cast<int>(to_m / image.line_m);
       ++line) {
    for (int beam = 0; beam < end_beam; ++beam) {
      codes.push_back(image.at(line + lag_lines, beam + lag_beams));
    }
  }
  return codes;
}

/// @param intensity of the echo in all beams and lines; 0: noise only
GeminiImage image_of(float intensity, double range_m, int compression_log2 = 0) {
  gemini::PingSettings wanted;
  wanted.range_m = range_m;
  wanted.compression_log2 = compression_log2;
  test::GeminiClient client(server::gemini_type().make_default(), gemini::make_ping_config(wanted),
                            test::EvenEcho(intensity));
  return client.images(1).front();
}

/// Noise below the ceiling of the TVG, where all lines have the same level.
double noise_variation(int compression_log2) {
  const std::vector<double> codes = codes_of(image_of(0, 60, compression_log2), 45, 58);
  return sd_of(codes) / mean_of(codes);
}

double noise_correlation(int lag_lines, int lag_beams) {
  const GeminiImage image = image_of(0, 60);
  return test::correlation(codes_of(image, 45, 58), codes_of(image, 45, 58, lag_lines, lag_beams));
}

/// An echo far above the noise at 20 to 22 m, where TVG changes little. At 50 m, clients request 32 cycles,
/// i.e. four lines.
double echo_correlation(int lag_lines) {
  constexpr float intensity = 3e-10F;
  const GeminiImage image = image_of(intensity, 50);
  return test::correlation(codes_of(image, 20, 22), codes_of(image, 20, 22, lag_lines));
}

}  // namespace

std::vector<Row> gemini_noise_rows() {
  const auto noise = [](int lines, int beams) { return [=] { return noise_correlation(lines, beams); }; };
  const auto echo = [](int lines) { return [=] { return echo_correlation(lines); }; };
  return {
      {"Gemini", "noise: coefficient of variation", "0.528", 0.51, 0.54, "",
       [] { return noise_variation(0); }},
      {"Gemini", "the same, four bins averaged to one", "0.30 to 0.38", 0.26, 0.38, "",
       [] { return noise_variation(2); }},
      {"Gemini", "noise: correlation with the next beam", "0.75", 0.70, 0.80, "", noise(0, 1)},
      {"Gemini", "with the one after", "0.34", 0.29, 0.39, "", noise(0, 2)},
      {"Gemini", "with the third", "0.08", 0.03, 0.13, "", noise(0, 3)},
      {"Gemini", "noise: correlation with the next bin", "0.08", 0.04, 0.12, "", noise(1, 0)},
      {"Gemini", "echo: correlation with the next bin", "0.8", 0.7, 0.9, "", echo(1)},
      {"Gemini", "with the one after", "0.45", 0.35, 0.55, "", echo(2)},
      {"Gemini", "with the third", "0.2", 0.1, 0.3, "", echo(3)},
      {"Gemini", "with the fourth", "0.05", 0.0, 0.15, "", echo(4)},
      {"Gemini", "empty water at 2 to 4 m, range of 20 m: median code", "1 to 5", 1, 5, "",
       [] { return quantile_of(codes_of(image_of(0, 20), 2, 4), 0.5); }},
      {"Gemini", "noise of the last quarter of 50 m: change of level", "within 1", -1, 1, "dB",
       [] {
         const GeminiImage image = image_of(0, 50);
         return 2 * decibels(mean_of(codes_of(image, 46, 49)) / mean_of(codes_of(image, 38, 41)));
       }},
  };
}

}  // namespace sonard::realism
