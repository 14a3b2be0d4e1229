// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/point_spread.hpp"

#include <utility>
#include <vector>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/steady_echo.hpp"

namespace sonard::render {

void PointSpread::prepare(const SonarSettings& settings, std::uint64_t seed, int head,
                          const SkipSwitches& skip, SkipCounts& skipped) {
  uses_pattern_ = false;
  uses_pulse_ = false;
  energy_ = 1;
  if (settings.model == Model::paper) {
    return;
  }
  energy_ = pulse_energy(settings.physical.pulse, settings.range.step_m);
  if (has_array_beams(settings)) {
    prepare_pattern(settings, seed, head, skip, skipped);
  }
  if (settings.physical.pulse.shape != PulseSettings::Shape::point &&
      settings.physical.pulse.range_cell_m > 0) {
    prepare_pulse(settings, skip, skipped);
  }
}

void PointSpread::prepare_pattern(const SonarSettings& settings, std::uint64_t seed, int head,
                                  const SkipSwitches& skip, SkipCounts& skipped) {
  if (pattern_ && aperture_ == settings.aperture && seed_ == seed && skip.on(SkipRule::unchanged_settings)) {
    skipped.add(SkipRule::unchanged_settings);
  } else {
    // Ping number 0: element errors belong to the sonar and do not change from ping to ping.
    pattern_.emplace(settings.aperture, make_random_key(settings.aperture.element_seed.value_or(seed), head,
                                                        RandomField::array_elements, 0));
    aperture_ = settings.aperture;
    seed_ = seed;
  }
  uses_pattern_ = true;
  const bool planar = settings.aperture.bearing == Aperture::Bearing::planar;
  if (planar && pattern_->change() <= entry_of(SkipRule::separate_beams).bound &&
      skip.on(SkipRule::separate_beams)) {
    skipped.add(SkipRule::separate_beams);
    uses_pattern_ = false;
  }
}

void PointSpread::prepare_pulse(const SonarSettings& settings, const SkipSwitches& skip,
                                SkipCounts& skipped) {
  const PulseSettings& pulse = settings.physical.pulse;
  const double step_m = settings.range.step_m;
  if (pulse_ && pulse_->made_of == pulse && pulse_->step_m == step_m &&
      skip.on(SkipRule::unchanged_settings)) {
    skipped.add(SkipRule::unchanged_settings);
  } else {
    pulse_ = {pulse, step_m,
              PulseResponse(pulse.shape, pulse.range_cell_m, step_m, pulse.tone_rounding_m, energy_)};
  }
  uses_pulse_ = true;
  // A bin loses at most this share, and gains at most this share of the bins around it.
  if (2 * pulse_->response.share_outside() <= entry_of(SkipRule::short_pulse).bound &&
      skip.on(SkipRule::short_pulse)) {
    skipped.add(SkipRule::short_pulse);
    uses_pulse_ = false;
  }
}

SonarSettings PointSpread::sampled(const SonarSettings& settings) {
  SonarSettings fine = settings;
  fine.aperture.beam_edges_rad = fine_beam_edges(settings.aperture);
  return fine;
}

void PointSpread::form_beams(const EchoImage& fine, const SonarSettings& settings, EchoImage& beams,
                             WorkerPool& workers, const SkipSwitches& skip, SkipCounts& skipped) const {
  // Echoes below the noise are ignored. Points come before the pattern so that the beams, which are used
  // next, stay in the caches.
  const NoiseSettings& noise = settings.physical.noise;
  const double faintest = noise.on ? decibels_to_power(noise.level_db) / energy_ : 0.0;
  const std::vector<PointEcho> points =
      find_points(fine, mixing_reach(settings), static_cast<float>(faintest), workers);
  pattern_->apply(fine, beams, workers, skip, skipped);
  beams.steady =
      receive_points(points, fine, *pattern_, uses_pulse_ ? &pulse_->response : nullptr, beams.beams);
}

void PointSpread::spread(EchoImage& echo, WorkerPool& workers) {
  if (uses_pulse_) {
    pulse_->response.apply(echo, memory_, workers);
    std::swap(echo.intensity, memory_.intensity);
  } else if (energy_ != 1) {
    const auto energy = static_cast<float>(energy_);
    for (std::vector<float>* intensity : {&echo.intensity, &echo.steady.intensity}) {
      for (float& value : *intensity) {
        value *= energy;
      }
    }
  }
}

void PointSpread::spread_lines(std::vector<float>& lines, WorkerPool& workers) const {
  if (uses_pulse_) {
    EchoImage spread;
    const auto count = static_cast<int>(lines.size());
    pulse_->response.apply({1, count, std::move(lines)}, spread, workers);
    lines = std::move(spread.intensity);
  }
}

}  // namespace sonard::render
