// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/quantizer.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

SONARD_SIMD_CLONES
void add_row(const float* __restrict row, int count, float* __restrict sum) {
  for (int b = 0; b < count; ++b) {
    sum[b] += row[b];
  }
}

SONARD_SIMD_CLONES
void raise_row(const float* __restrict row, int count, float* __restrict peak) {
  for (int b = 0; b < count; ++b) {
    peak[b] = std::max(peak[b], row[b]);
  }
}

SONARD_SIMD_CLONES
void quantise_row(const float* __restrict codes, int count, std::uint8_t* __restrict out) {
  for (int b = 0; b < count; ++b) {
    out[b] = static_cast<std::uint8_t>(static_cast<std::int32_t>(std::min(255.0F, codes[b] + 0.5F)));
  }
}

SONARD_SIMD_CLONES
void quantise_row(const float* __restrict codes, int count, std::uint16_t* __restrict out) {
  for (int b = 0; b < count; ++b) {
    out[b] = static_cast<std::uint16_t>(static_cast<std::int32_t>(std::min(65535.0F, codes[b] + 0.5F)));
  }
}

/// @param full code of full scale; codes stay below it
template <class Code>
void quantise_power(const float* codes, float exponent, float full, int count, Code* out) {
  for (int b = 0; b < count; ++b) {
    const float code = full * std::pow(codes[b] / full, exponent);
    out[b] = static_cast<Code>(std::min(full - 1.0F, code));
  }
}

void add_decibels(const float* amplitude, float weight, int count, float* sum) {
  for (int b = 0; b < count; ++b) {
    sum[b] += weight * (20 * std::log10(std::max(amplitude[b], 1e-6F)));
  }
}

/// Codes of a scanning head: v = floor(k 255 / 160) with k half decibels, at most 120 (docs/physics.md 2.16).
void quantise_decibels(const float* sum_db, float terms, int count, std::uint8_t* out) {
  constexpr float full_scale_db = 80.0F;
  constexpr int highest = 120;
  for (int b = 0; b < count; ++b) {
    const float level_db = full_scale_db + sum_db[b] / terms;
    const int half_decibels = std::clamp(static_cast<int>(std::lround(2 * level_db)), 0, highest);
    out[b] = static_cast<std::uint8_t>(half_decibels * 255 / 160);
  }
}

}  // namespace

PingSamples make_samples(const SonarSettings& settings) {
  PingSamples samples;
  samples.beams = settings.aperture.beam_count();
  samples.bins = settings.range.output_count();
  const std::size_t size = static_cast<std::size_t>(samples.beams) * static_cast<std::size_t>(samples.bins);
  settings.sixteen_bit ? samples.u16.resize(size) : samples.u8.resize(size);
  return samples;
}

float codes_per_amplitude(const SonarSettings& settings) {
  const bool decibels = settings.output_scale == OutputScale::half_decibels;
  const float highest_code = settings.sixteen_bit ? 65535.0F : 255.0F;
  const float full_scale = decibels ? 1.0F : highest_code / static_cast<float>(settings.output_full_scale);
  const int shares = settings.range.compression_peak ? 1 : 1 << settings.range.compression_log2;
  return full_scale / static_cast<float>(shares);
}

Quantizer::Quantizer(const SonarSettings& settings, PingSamples& samples)
    : samples_(samples),
      scale_(settings.output_scale),
      exponent_(static_cast<float>(settings.output_exponent)),
      peak_(settings.range.compression_peak),
      sum_(static_cast<std::size_t>(samples.beams)) {}

void Quantizer::begin() {
  terms_ = 0;
}

void Quantizer::add(const float* codes, float weight) {
  const bool first = terms_ == 0;
  terms_ += weight;
  if (scale_ == OutputScale::half_decibels) {
    if (first) {
      std::fill_n(sum_.data(), samples_.beams, 0.0F);
    }
    add_decibels(codes, weight, samples_.beams, sum_.data());
  } else if (first) {
    std::copy_n(codes, samples_.beams, sum_.data());
  } else if (peak_) {
    raise_row(codes, samples_.beams, sum_.data());
  } else {
    add_row(codes, samples_.beams, sum_.data());
  }
}

void Quantizer::end(int output_line) {
  if (terms_ == 0) {
    return;  // the samples are zero from the start
  }
  const auto beams = static_cast<std::size_t>(samples_.beams);
  const std::size_t at = static_cast<std::size_t>(output_line) * beams;
  if (scale_ == OutputScale::half_decibels) {
    quantise_decibels(sum_.data(), terms_, samples_.beams, &samples_.u8[at]);
  } else if (scale_ == OutputScale::power && samples_.u16.empty()) {
    quantise_power(sum_.data(), exponent_, 255.0F, samples_.beams, &samples_.u8[at]);
  } else if (scale_ == OutputScale::power) {
    quantise_power(sum_.data(), exponent_, 65535.0F, samples_.beams, &samples_.u16[at]);
  } else if (samples_.u16.empty()) {
    quantise_row(sum_.data(), samples_.beams, &samples_.u8[at]);
  } else {
    quantise_row(sum_.data(), samples_.beams, &samples_.u16[at]);
  }
}

}  // namespace sonard::render
