// SPDX-License-Identifier: Apache-2.0
// Rules of array and pulse: each on against off, same echo.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/point_spread.hpp"
#include "tests/support/degree.hpp"

namespace sonard::render {
namespace {

constexpr int line_count = 256;

SonarSettings settings_of(std::vector<double> edges_rad) {
  SonarSettings settings;
  settings.aperture.beam_edges_rad = std::move(edges_rad);
  settings.aperture.azimuth = Aperture::Azimuth::array;
  settings.range = {line_count, 0.01, 0, false};
  return settings;
}

/// Empty lines, then scattered points, then an echo that fills the fan evenly within half a percent.
EchoImage echo_of(const Aperture& aperture) {
  const int beams = aperture.beam_count();
  EchoImage echo{
      beams, line_count,
      std::vector<float>(static_cast<std::size_t>(beams) * static_cast<std::size_t>(line_count), 0.0F)};
  for (int beam = 0; beam < beams; ++beam) {
    const auto b = static_cast<std::size_t>(beam);
    const double width_rad = aperture.beam_edges_rad[b] - aperture.beam_edges_rad[b + 1];
    for (int line = 100; line < line_count; ++line) {
      const bool even = line >= 160;
      const double level = even ? 1 + 0.005 * ((beam * 31 + line) % 2) : (beam * 7 + line) % 13 == 0 ? 2 : 0;
      echo.intensity[b * line_count + static_cast<std::size_t>(line)] = static_cast<float>(level * width_rad);
    }
  }
  return echo;
}

struct Reception {
  EchoImage echo;
  std::uint64_t skipped = 0;
};

/// The second of two pings.
Reception receive(SkipRule rule, const SkipSwitches& skip, const SonarSettings& settings) {
  WorkerPool workers(2);
  PointSpread reception;
  Reception outcome;
  for (int ping = 0; ping < 2; ++ping) {
    SkipCounts skipped;
    reception.prepare(settings, 1, 0, skip, skipped);
    // With or without the pattern, the engine samples the same fine beams.
    const SonarSettings fine = PointSpread::sampled(settings);
    const EchoImage seen = echo_of(fine.aperture);
    if (reception.has_pattern()) {
      reception.form_beams(seen, settings, outcome.echo, workers, skip, skipped);
    } else {
      const int parts = settings.aperture.fine_beams;
      outcome.echo = {settings.aperture.beam_count(), line_count, {}};
      outcome.echo.intensity.resize(seen.intensity.size() / static_cast<std::size_t>(parts));
      for (int f = 0; f < seen.beams; ++f) {
        for (int line = 0; line < line_count; ++line) {
          outcome.echo.intensity[static_cast<std::size_t>(f / parts * line_count + line)] += seen.at(f, line);
        }
      }
    }
    reception.spread(outcome.echo, workers);
    outcome.skipped = skipped.of(rule);
  }
  return outcome;
}

/// On against off. The rule must have skipped `expected` times in the second ping.
void expect_within_bound(SkipRule rule, const SonarSettings& settings, std::uint64_t expected) {
  ASSERT_EQ(entry_of(rule).bound_unit, "of the image's maximum");
  const Reception on = receive(rule, {}, settings);
  EXPECT_EQ(on.skipped, expected);
  const Reception off = receive(rule, SkipSwitches{}.turn_off(rule), settings);
  EXPECT_EQ(off.skipped, 0u);
  ASSERT_EQ(on.echo.intensity.size(), off.echo.intensity.size());
  const float most = *std::max_element(off.echo.intensity.begin(), off.echo.intensity.end());
  ASSERT_GT(most, 0.0F);
  double worst = 0;
  for (std::size_t i = 0; i < on.echo.intensity.size(); ++i) {
    worst = std::max(worst, std::abs(static_cast<double>(on.echo.intensity[i]) -
                                     static_cast<double>(off.echo.intensity[i])));
  }
  EXPECT_LE(worst, entry_of(rule).bound * static_cast<double>(most));
}

SonarSettings gemini() {
  return settings_of(equal_sine_edges(256, 60 * degree));
}

TEST(ReceptionRules, BeamsFarWiderThanTheArraysStaySeparate) {
  SonarSettings settings = settings_of(equal_angle_edges(3, 60 * degree));
  settings.aperture.receive_beamwidth_rad = 0.1 * degree;
  expect_within_bound(SkipRule::separate_beams, settings, 1);
  settings.aperture.fine_beams = 3;  // the outer ones contribute nothing
  expect_within_bound(SkipRule::separate_beams, settings, 0);
  expect_within_bound(SkipRule::separate_beams, gemini(), 0);
}

// 96 lines of 100 without an echo, and all from 160 on, are whole tiles of 32.
TEST(ReceptionRules, EvenLinesAreNotSpreadOverBeams) {
  expect_within_bound(SkipRule::even_bins, gemini(), 96 + 96);
  SonarSettings with_errors = gemini();
  with_errors.aperture.element_phase_sd_rad = 0.5;
  expect_within_bound(SkipRule::even_bins, with_errors, 96 + 96);
}

TEST(ReceptionRules, PerfectElementsLeakNothing) {
  SonarSettings settings = gemini();
  expect_within_bound(SkipRule::perfect_elements, settings, 1);
  settings.aperture.element_amplitude_sd = 0.3;
  expect_within_bound(SkipRule::perfect_elements, settings, 0);
}

TEST(ReceptionRules, APulseFarShorterThanALineIsAPoint) {
  SonarSettings settings = gemini();
  settings.physical.pulse.shape = PulseSettings::Shape::tone;
  settings.physical.pulse.range_cell_m = settings.range.step_m / 51;
  expect_within_bound(SkipRule::short_pulse, settings, 1);
  // Two cells to a line are not enough: an eighth of a tone and a fifth of a chirp fall outside.
  settings.physical.pulse.range_cell_m = settings.range.step_m / 2;
  expect_within_bound(SkipRule::short_pulse, settings, 0);
  settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  expect_within_bound(SkipRule::short_pulse, settings, 0);
}

TEST(ReceptionRules, TablesAreMadeOnce) {
  SonarSettings settings = gemini();
  settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  settings.physical.pulse.range_cell_m = 0.02;
  expect_within_bound(SkipRule::unchanged_settings, settings, 2);
}

}  // namespace
}  // namespace sonard::render
