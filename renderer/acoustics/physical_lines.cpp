#include "renderer/acoustics/physical_lines.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/complex_row.hpp"
#include "renderer/acoustics/receive_lines.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using Speckle = PhysicalModel::Speckle;

/// Envelope of echo plus noise.
SONARD_SIMD_CLONES
void envelope_row(const float* __restrict echo, float floor, const float* __restrict speckle_re,
                  const float* __restrict speckle_im, float noise, const float* __restrict profile,
                  const float* __restrict noise_re, const float* __restrict noise_im, float gain, int beams,
                  float* __restrict out) {
  for (int b = 0; b < beams; ++b) {
    const float amplitude = std::sqrt(echo[b] + floor);
    const float n = noise * profile[b];
    const float re = amplitude * speckle_re[b] + n * noise_re[b];
    const float im = amplitude * speckle_im[b] + n * noise_im[b];
    out[b] = gain * std::sqrt(re * re + im * im);
  }
}

/// Envelope of noise alone.
SONARD_SIMD_CLONES
void noise_envelope_row(float noise, const float* __restrict profile, const float* __restrict noise_re,
                        const float* __restrict noise_im, float gain, int beams, float* __restrict out) {
  const float scale = gain * noise;
  for (int b = 0; b < beams; ++b) {
    out[b] = scale * profile[b] * std::sqrt(noise_re[b] * noise_re[b] + noise_im[b] * noise_im[b]);
  }
}

/// Native lines one by one, in a thread of their own.
class PhysicalLines {
 public:
  PhysicalLines(const PhysicalPing& ping, const EchoBlock& block)
      : ping_(ping),
        block_(block),
        beams_(ping.tables.filter.beams()),
        copies_(ping.tables.filter.copies() && ping.skip.on(SkipRule::narrow_aperture)),
        white_(ping.tables.filter.row_width()),
        speckle_(copies_ ? ping.tables.filter.row_width() : beams_),
        noise_(copies_ ? ping.tables.filter.row_width() : beams_),
        codes_(static_cast<std::size_t>(beams_)) {
    if (ping.tables.model.speckle == Speckle::off) {
      std::fill_n(speckle_.real(), beams_, 1.0F);  // the echo is a constant phasor
    }
  }

  void add_native_line(int native, OutputLines& output) {
    const ReceiverTables& tables = ping_.tables;
    // The device puts out exactly 0 in its near field.
    const bool blanked = (native + 0.5) * tables.range.step_m < tables.model.near_field_blank_m;
    if (blanked && skips(SkipRule::blanked_near_field)) {
      return;
    }
    const float gain = blanked ? 0.0F : tables.gain[static_cast<std::size_t>(native)];
    const float strongest = block_.strongest(native);
    const bool silent = tables.noise == 0 && skips(SkipRule::no_noise);
    const Phasors noise = silent ? silence() : draw(ping_.noise_key, native, noise_);
    // No echo in any beam, and so no leak either: speckle would multiply 0. Later images get other random
    // numbers of the same distribution, as the field makes up for what it missed (SpeckleField).
    if (!(strongest > 0) && skips(SkipRule::lines_without_echo)) {
      if (silent) {
        return;
      }
      noise_envelope_row(tables.noise, tables.profile.data(), noise.real, noise.imaginary, gain, beams_,
                         codes_.data());
    } else {
      const Phasors phasors = speckle_of(native);
      envelope_row(block_.line(native), tables.leak * strongest, phasors.real, phasors.imaginary,
                   tables.noise, tables.profile.data(), noise.real, noise.imaginary, gain, beams_,
                   codes_.data());
    }
    output.add(codes_.data());
  }

  const SkipCounts& skipped() const { return skipped_; }

 private:
  struct Phasors {
    const float* real;
    const float* imaginary;
  };

  /// Counts too: to be asked only where the criterion of the rule is met.
  bool skips(SkipRule rule) {
    const bool on = ping_.skip.on(rule);
    skipped_.add(rule, on ? 1 : 0);
    return on;
  }

  /// What noise of amplitude 0 is drawn as: nothing ever writes to the row, so it is 0 throughout.
  Phasors silence() const { return {noise_.real(), noise_.imaginary()}; }

  Phasors speckle_of(int native) {
    switch (ping_.tables.model.speckle) {
      case Speckle::off:
        break;
      case Speckle::per_ping:
        return draw(ping_.speckle_key, native, speckle_);
      case Speckle::frozen:
      case Speckle::ou:
        if (!ping_.speckle.is_current(native) || !skips(SkipRule::unmoved_speckle)) {
          const Phasors fresh = draw(ping_.speckle_key, native, speckle_);
          ping_.speckle.evolve(native, fresh.real, fresh.imaginary);
        }
        return {ping_.speckle.real(native), ping_.speckle.imaginary(native)};
    }
    return {speckle_.real(), speckle_.imaginary()};
  }

  /// CN(0, 1) of one line with the grain of the array, in `row` or a part of it.
  Phasors draw(RandomKey key, int native, ComplexRow& row) {
    const BeamFilter& filter = ping_.tables.filter;
    if (copies_) {
      skipped_.add(SkipRule::narrow_aperture);
      row.draw(key, native);
      return {filter.middle(row.real()), filter.middle(row.imaginary())};
    }
    white_.draw(key, native);
    row.filter(filter, white_);
    return {row.real(), row.imaginary()};
  }

  const PhysicalPing& ping_;
  const EchoBlock& block_;
  int beams_;
  bool copies_;  ///< beams share nothing: rows are as they are drawn
  ComplexRow white_, speckle_, noise_;
  AlignedVector<float> codes_;
  SkipCounts skipped_;
};

}  // namespace

PingSamples receive_physical(const EchoImage& echo, const PhysicalPing& ping, const SonarSettings& settings,
                             WorkerPool& workers, SkipCounts& skipped) {
  return receive_lines<PhysicalLines>(echo, ping, settings, workers, skipped);
}

}  // namespace sonard::render
