// SPDX-License-Identifier: Apache-2.0
// Images of a scanning head: noise, ring-down, bursts and lines.
#include <numbers>

#include "tests/realism/rows.hpp"
#include "tests/realism/statistics.hpp"
#include "tests/support/correlation.hpp"
#include "tests/support/micron_client.hpp"

namespace sonard::realism {
namespace {

using test::decibels_of;
using test::MicronClient;

constexpr double bin_m = 0.064;
constexpr int bins = 780;  // 50 m
constexpr int steps = 200;

/// Levels of a turn in steps of 1.8 degrees, line after line, in dB, from one range to another.
std::vector<std::vector<double>> turn(MicronClient& client, float intensity, double from_m, double to_m) {
  std::vector<std::vector<double>> lines;
  for (int step = 0; step < steps; ++step) {
    const std::vector<std::uint8_t> codes = client.line(intensity, true, step * 2 * std::numbers::pi / steps);
    lines.emplace_back();
    for (auto bin = static_cast<std::size_t>(from_m / bin_m); bin < static_cast<std::size_t>(to_m / bin_m);
         ++bin) {
      lines.back().push_back(decibels_of(codes[bin]));
    }
  }
  return lines;
}

std::vector<double> joined(const std::vector<std::vector<double>>& lines, std::size_t from = 0,
                           std::size_t without_last = 0) {
  std::vector<double> all;
  for (std::size_t i = from; i + without_last < lines.size(); ++i) {
    all.insert(all.end(), lines[i].begin(), lines[i].end());
  }
  return all;
}

std::vector<double> means(const std::vector<std::vector<double>>& lines) {
  std::vector<double> all;
  for (const std::vector<double>& line : lines) {
    all.push_back(mean_of(line));
  }
  return all;
}

/// Levels of a turn for an even echo about 25 dB above the noise. The mean at each range is removed, because
/// it grows with the TVG.
std::vector<std::vector<double>> echo_turn(MicronClient& client) {
  std::vector<std::vector<double>> lines = turn(client, 1e-7F, 8, 12);
  for (std::size_t bin = 0; bin < lines.front().size(); ++bin) {
    double mean = 0;
    for (const std::vector<double>& line : lines) {
      mean += line[bin] / static_cast<double>(lines.size());
    }
    for (std::vector<double>& line : lines) {
      line[bin] -= mean;
    }
  }
  return lines;
}

MicronClient client_at(double gain_percent) {
  MicronClient client{server::micron_type().make_default(), bin_m, bins};
  client.gain_db = 0.8 * gain_percent;
  return client;
}

/// Median over the lines of a turn of the noise's standard deviation along the line.
double noise_sd() {
  MicronClient client = client_at(45);
  std::vector<double> of_lines;
  for (const std::vector<double>& line : turn(client, 0, 36, 49)) {
    of_lines.push_back(sd_of(line));
  }
  return quantile_of(of_lines, 0.5);
}

/// Correlation from bin to bin, of noise below the ceiling of the TVG or of an even echo.
/// @param noise true: noise only, no echo
double bins_shared(bool noise) {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.noise.interference.probability = 0;
  head.acoustics.physical.noise.by_bearing_db = 0;
  MicronClient client{head, bin_m, bins};
  client.gain_db = 0.8 * 45;
  std::vector<double> here, next;
  for (const std::vector<double>& line : noise ? turn(client, 0, 38, 49) : echo_turn(client)) {
    here.insert(here.end(), line.begin(), line.end() - 1);
    next.insert(next.end(), line.begin() + 1, line.end());
  }
  return test::correlation(here, next);
}

double zeros() {
  MicronClient client = client_at(28);
  const std::vector<double> levels = joined(turn(client, 0, 1.2, 49.9));
  return static_cast<double>(std::count(levels.begin(), levels.end(), 0.0)) /
         static_cast<double>(levels.size());
}

double echo_shared(std::size_t lines) {
  MicronClient client = client_at(45);
  const auto levels = echo_turn(client);
  return test::correlation(joined(levels, 0, lines), joined(levels, lines));
}

double sweeps_shared() {
  MicronClient client = client_at(45);
  const auto first = echo_turn(client);
  return test::correlation(joined(first), joined(echo_turn(client)));
}

std::vector<double> ring_down_peaks(double gain_percent) {
  MicronClient client = client_at(gain_percent);
  std::vector<double> peaks;
  for (const std::vector<double>& line : turn(client, 0, 0.1, 1)) {
    peaks.push_back(*std::max_element(line.begin(), line.end()));
  }
  return peaks;
}

double level_behind_ring_down() {
  MicronClient client = client_at(88);
  return mean_of(joined(turn(client, 0, 1.2, 2)));
}

double bearings_differ() {
  MicronClient client = client_at(45);
  const std::vector<double> levels = means(turn(client, 0, 36, 49));
  return quantile_of(levels, 0.95) - quantile_of(levels, 0.02);
}

double bearings_stay() {
  MicronClient client = client_at(45);
  const std::vector<double> first = means(turn(client, 0, 36, 49));
  return test::correlation(first, means(turn(client, 0, 36, 49)));
}

/// Share of lines whose noise is raised for a metre or more. The noise does not depend on the bearing
/// otherwise.
double lines_hit() {
  server::HeadConfig head = server::micron_type().make_default();
  head.acoustics.physical.noise.by_bearing_db = 0;
  MicronClient client{head, bin_m, bins};
  constexpr std::size_t window = 30;
  int hit = 0;
  constexpr int turns = 10;
  for (int i = 0; i < turns; ++i) {
    for (const std::vector<double>& line : turn(client, 0, 30, 49.9)) {
      const double quiet_db = quantile_of(line, 0.3);
      bool raised = false;
      for (std::size_t begin = 0; begin + window <= line.size(); begin += window / 2) {
        const std::vector<double> part(line.begin() + static_cast<std::ptrdiff_t>(begin),
                                       line.begin() + static_cast<std::ptrdiff_t>(begin + window));
        raised = raised || mean_of(part) > quiet_db + 3.2;
      }
      hit += raised ? 1 : 0;
    }
  }
  return static_cast<double>(hit) / (turns * steps);
}

}  // namespace

std::vector<Row> micron_rows() {
  return {
      {"Micron", "noise in bins of 64 mm: standard deviation", "2.5 to 3.2", 2.5, 3.2, "dB", noise_sd},
      {"Micron", "noise: correlation with the next bin", "0.38 to 0.49", 0.38, 0.49, "",
       [] { return bins_shared(true); }},
      {"Micron", "echo: correlation with the next bin", "0.38 to 0.49", 0.38, 0.49, "",
       [] { return bins_shared(false); }},
      {"Micron", "empty water to 50 m, gain 28 %: share of zeros", "0.29", 0.21, 0.37, "", zeros},
      {"Micron", "the same: mean level beyond 34 m", "4 to 6, flat", 4, 6, "dB",
       [] {
         MicronClient client = client_at(28);
         return mean_of(joined(turn(client, 0, 35, 49)));
       }},
      {"Micron", "echo: correlation with the line 1.8 degrees on", "0.47", 0.3, 0.6, "",
       [] { return echo_shared(1); }},
      {"Micron", "echo: correlation with the next sweep, same direction", "0.95", 0.92, 0.98, "",
       sweeps_shared},
      {"Micron", "ring-down at a gain of 58 %", "20 to 25", 20, 25.5, "dB",
       [] { return mean_of(ring_down_peaks(58)); }},
      {"Micron", "ring-down at a gain of 88 %", "52", 48, 56, "dB",
       [] { return mean_of(ring_down_peaks(88)); }},
      {"Micron", "ring-down: standard deviation from ping to ping", "1.5 to 3", 1.5, 3, "dB",
       [] { return sd_of(ring_down_peaks(58)); }},
      {"Micron", "the vehicle behind it at 1.2 to 2 m, gain 88 %", "some", 10, 45, "dB",
       level_behind_ring_down},
      {"Micron", "lines with a burst of interference between 30 and 50 m", "0.05 to 0.18", 0.05, 0.18, "",
       lines_hit},
      {"Micron", "noise: difference between bearings", "up to 7", 4, 8, "dB", bearings_differ},
      {"Micron", "the same: correlation with the next sweep", "stays", 0.9, 1, "", bearings_stay},
  };
}

}  // namespace sonard::realism
