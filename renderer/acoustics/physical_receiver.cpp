// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/physical_receiver.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "renderer/acoustics/complex_row.hpp"
#include "renderer/acoustics/receive_bins.hpp"
#include "renderer/acoustics/texture.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// Envelope of the sum of an echo with speckle, a steady amplitude without speckle, and noise.
SONARD_SIMD_CLONES
void envelope_row(const float* __restrict echo, const float* __restrict speckle_re,
                  const float* __restrict speckle_im, const float* __restrict steady, float noise,
                  const float* __restrict profile, const float* __restrict noise_re,
                  const float* __restrict noise_im, float gain, int beams, float* __restrict out) {
  for (int b = 0; b < beams; ++b) {
    const float amplitude = std::sqrt(echo[b]);
    const float n = noise * profile[b];
    const float re = (amplitude * speckle_re[b] + steady[b]) + n * noise_re[b];
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

/// Makes range bins one by one; one object per thread.
class PhysicalBins {
 public:
  PhysicalBins(const PhysicalReceiverInput& ping, const EchoBlock& block)
      : ping_(ping),
        block_(block),
        beams_(ping.tables.filter.beams()),
        speckle_(ping.tables.filter, ping.tables.pulse_correlation, ping.speckle, ping.skip, skipped_),
        texture_(ping.tables.filter, ping.tables.pulse_correlation, ping.texture, ping.skip, skipped_),
        noise_(ping.tables.filter, ping.tables.noise_correlation, ping.noise, ping.skip, skipped_),
        silence_(beams_),
        still_(beams_),
        textured_(static_cast<std::size_t>(beams_)),
        steady_(static_cast<std::size_t>(beams_)),
        diffuse_(static_cast<std::size_t>(beams_)),
        codes_(static_cast<std::size_t>(beams_)) {
    std::fill_n(still_.real(), beams_, 1.0F);
  }

  void add_range_bin(int bin, Quantizer& output) {
    const ReceiverTables& tables = ping_.tables;
    // The device outputs exactly 0 in its near field.
    const bool blanked = range_m(bin) < tables.model.near_field_blank_m;
    if (blanked && skips(SkipRule::blanked_near_field)) {
      return;
    }
    gain_ = blanked ? 0.0F : tables.gain[static_cast<std::size_t>(bin)];
    const float ring_down = ring_down_at(bin);
    if (steady_is_ != ring_down) {
      std::ranges::fill(steady_, ring_down);
      steady_is_ = ring_down;
    }
    noise_level_ = noise_level_at(bin);
    const float strongest = block_.strongest(bin);
    note_echo(bin, strongest);
    has_echo_ =
        strongest > 0 || ring_down != 0 || has_reverberation(bin) || !skips(SkipRule::bins_without_echo);
    if (const float* steady = block_.steady(bin); steady != nullptr) {
      take_apart(block_.line(bin), steady);
    }
    const int begin = bin * tables.cells, end = begin + tables.cells;
    const int cells = tables.range.count * tables.cells;
    if (tables.overlap > 0) {
      add_cell(bin, std::max(begin - 1, 0), tables.overlap, output);
    }
    for (int cell = begin; cell < end; ++cell) {
      add_cell(bin, cell, 1.0F, output);
    }
    if (tables.overlap > 0) {
      add_cell(bin, std::min(end, cells - 1), tables.overlap, output);
    }
  }

  const SkipCounts& skipped() const { return skipped_; }
  /// PingStatistics::echo_over_floor of the bins added so far.
  double echo_over_floor() const { return echo_over_floor_; }

 private:
  void note_echo(int bin, float strongest) {
    if (!(strongest > 0) || !(gain_ > 0)) {
      return;
    }
    // The amplitude that becomes the lowest code above 0.
    const bool decibels = ping_.tables.output_scale == OutputScale::half_decibels;
    const double least = (decibels ? 1e-4 : 0.5) / static_cast<double>(gain_);
    const auto noise = static_cast<double>(noise_level_);
    const double surface = static_cast<double>(strongest) * static_cast<double>(block_.surface_share(bin));
    echo_over_floor_ = std::max(echo_over_floor_, surface / (noise * noise + least * least));
  }

  /// @param cell of the fields; with several beams a line is one cell. A cell beside the line has its own
  /// speckle and noise but the mean echo of the line: the overlap spreads that by less than a line.
  void add_cell(int bin, int cell, float weight, Quantizer& output) {
    const bool silent = noise_level_ == 0 && skips(SkipRule::no_noise);
    const Phasors noise = silent ? Phasors{silence_.real(), silence_.imaginary()} : noise_.line(cell);
    // If no beam has an echo, speckle would multiply 0. Skipping it gives later images other random numbers
    // of the same distribution, because SpeckleField makes up for missed steps.
    if (has_echo_) {
      const Phasors phasors = speckle_of(cell);
      envelope_row(echo_of(bin, cell), phasors.real, phasors.imaginary, steady_.data(), noise_level_,
                   ping_.tables.profile.data(), noise.real, noise.imaginary, gain_, beams_, codes_.data());
    } else if (silent) {
      return;
    } else {
      noise_envelope_row(noise_level_, ping_.tables.profile.data(), noise.real, noise.imaginary, gain_,
                         beams_, codes_.data());
    }
    output.add(codes_.data(), weight);
  }

  /// Also counts the skip: call it only if the criterion of the rule is met.
  bool skips(SkipRule rule) {
    const bool on = ping_.skip.on(rule);
    skipped_.add(rule, on ? 1 : 0);
    return on;
  }

  double range_m(int bin) const { return (bin + 0.5) * ping_.tables.range.step_m; }

  float ring_down_at(int bin) {
    const ReceiverTables& tables = ping_.tables;
    if (!tables.rings) {
      return 0.0F;
    }
    const bool over = bin >= tables.ring_down_bins && skips(SkipRule::ring_down_over);
    return over ? 0.0F : ping_.ring_down * tables.ring_down[static_cast<std::size_t>(bin)];
  }

  /// Amplitude before TVG.
  float noise_level_at(int bin) {
    const float level = ping_.noise_factor * ping_.tables.noise[static_cast<std::size_t>(bin)];
    if (!(ping_.tables.model.noise.interference.probability > 0) ||
        (!ping_.interference.raises(bin) && skips(SkipRule::no_interference))) {
      return level;
    }
    return level * ping_.interference.factor_at(bin);
  }

  /// True if the vehicle reflects sound of a scanning head into this bin.
  bool has_reverberation(int bin) const {
    return ping_.tables.rings && ping_.tables.vehicle[static_cast<std::size_t>(bin)] > 0;
  }

  Phasors speckle_of(int cell) {
    const bool off = ping_.tables.model.speckle.kind == SpeckleSettings::Kind::off;
    return off ? Phasors{still_.real(), still_.imaginary()} : speckle_.line(cell);
  }

  /// Splits the echo into `diffuse_`, which gets speckle, and `steady_`, which does not.
  void take_apart(const float* echo, const float* steady) {
    steady_is_.reset();
    for (std::size_t b = 0; b < steady_.size(); ++b) {
      diffuse_[b] = std::max(echo[b] - steady[b], 0.0F);
      steady_[b] += std::sqrt(steady[b]);
    }
  }

  const float* echo_of(int bin, int cell) {
    const float* echo = textured(bin, cell);
    if (!has_reverberation(bin)) {
      return echo;
    }
    for (std::size_t b = 0; b < textured_.size(); ++b) {
      textured_[b] = echo[b] + ping_.tables.vehicle[static_cast<std::size_t>(bin)];
    }
    return textured_.data();
  }

  /// The echo times its texture.
  const float* textured(int bin, int cell) {
    const SpeckleSettings& speckle = ping_.tables.model.speckle;
    const float* echo = block_.steady(bin) != nullptr ? diffuse_.data() : block_.line(bin);
    if (!(speckle.texture_nu > 0) || speckle.kind == SpeckleSettings::Kind::off) {
      return echo;
    }
    const double scatterers = scatterers_at(speckle, range_m(bin));
    if (scatterers > texture_ends_at_nu && skips(SkipRule::many_scatterers)) {
      return echo;
    }
    root_.set(scatterers);
    root_.apply(echo, texture_.real_line(cell), beams_, textured_.data());
    return textured_.data();
  }

  const PhysicalReceiverInput& ping_;
  const EchoBlock& block_;
  int beams_;
  // Of the current line:
  float gain_ = 0, noise_level_ = 0;
  bool has_echo_ = false;
  SkipCounts skipped_;
  double echo_over_floor_ = 0.0;
  FieldReader speckle_, texture_, noise_;
  ComplexRow silence_;  ///< noise of amplitude 0: 0 throughout
  ComplexRow still_;    ///< speckle that is off: a constant phasor
  TextureRoot root_;
  AlignedVector<float> textured_;
  std::optional<float> steady_is_ = 0.0F;  ///< value of steady_ in all beams; nullopt: beams differ
  AlignedVector<float> steady_;            ///< amplitude without speckle: points, ring-down
  AlignedVector<float> diffuse_;           ///< intensity without points, for lines with points
  AlignedVector<float> codes_;
};

/// Runs before any line is read, because another thread may own the neighbours of a line.
void evolve_whole(const RandomFieldOfPing& field, const PhysicalReceiverInput& ping, WorkerPool& workers,
                  SkipCounts& skipped) {
  const int reach = ping.tables.pulse_correlation.reach();
  if (field.kept == nullptr || reach == 0) {
    return;
  }
  const int lines = ping.tables.range.count * ping.tables.cells + 2 * reach;
  constexpr int lines_per_job = 64;
  const int jobs = (lines + lines_per_job - 1) / lines_per_job;
  std::mutex counting;
  workers.run(jobs, [&](int job) {
    SkipCounts own;
    FieldReader reader(ping.tables.filter, ping.tables.pulse_correlation, field, ping.skip, own);
    for (int line = job * lines_per_job; line < std::min((job + 1) * lines_per_job, lines); ++line) {
      reader.evolve(line - reach);
    }
    const std::lock_guard lock(counting);
    skipped += own;
  });
}

}  // namespace

void evolve_fields(const PhysicalReceiverInput& ping, WorkerPool& workers, SkipCounts& skipped) {
  evolve_whole(ping.speckle, ping, workers, skipped);
  evolve_whole(ping.texture, ping, workers, skipped);
}

PingSamples receive_physical(const EchoImage& echo, const PhysicalReceiverInput& ping,
                             const SonarSettings& settings, WorkerPool& workers, SkipCounts& skipped,
                             double& echo_over_floor) {
  evolve_fields(ping, workers, skipped);
  echo_over_floor = 0.0;
  return receive_bins<PhysicalBins>(echo, ping, settings, workers, [&](const PhysicalBins& bins) {
    skipped += bins.skipped();
    echo_over_floor = std::max(echo_over_floor, bins.echo_over_floor());
  });
}

}  // namespace sonard::render
