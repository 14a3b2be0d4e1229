#include "renderer/acoustics/receiver.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "renderer/acoustics/beam_kernel.hpp"
#include "renderer/acoustics/echo_block.hpp"
#include "renderer/acoustics/output_lines.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

using Speckle = PhysicalModel::Speckle;

double decibels_to_power(double decibels) {
  return std::pow(10.0, decibels / 10);
}

/// Real and imaginary part of one line, each starting on a cache line.
class ComplexRow {
 public:
  explicit ComplexRow(int width)
      : stride_(aligned_stride(width)), parts_(2 * static_cast<std::size_t>(stride_)) {}

  float* real() { return parts_.data(); }
  float* imaginary() { return parts_.data() + stride_; }
  const float* real() const { return parts_.data(); }
  const float* imaginary() const { return parts_.data() + stride_; }

  /// CN(0, 1) all along, the padding at the end included: whole vectors are faster than exact counts.
  void draw(RandomKey key, int line) {
    fill_complex_gaussian(key, static_cast<std::uint32_t>(line), stride_, real(), imaginary());
  }
  /// The filtered `white`.
  void filter(const BeamFilter& filter, const ComplexRow& white) {
    filter.apply(white.real(), real());
    filter.apply(white.imaginary(), imaginary());
  }

 private:
  int stride_;
  AlignedVector<float> parts_;
};

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

/// Noise amplitude per beam: 1, raised in a stripe two acoustic beams wide in the middle of the fan.
std::vector<float> noise_profile(const SonarSettings& settings) {
  std::vector<float> profile;
  const auto& edges = settings.aperture.beam_edges_rad;
  const double peak = decibels_to_power(settings.physical.broadside_stripe_db) - 1;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    const double x = 0.5 * (edges[b] + edges[b + 1]) / settings.aperture.receive_beamwidth_rad;
    profile.push_back(static_cast<float>(std::sqrt(1 + peak * std::exp(-x * x))));
  }
  return profile;
}

/// Shares blocks of lines among the threads. `Lines` is made once per thread, for its buffers, and takes
/// native lines one by one.
template <class Lines, class Ping>
PingSamples receive_lines(const EchoImage& echo, const Ping& ping, const SonarSettings& settings,
                          WorkerPool& workers, SkipCounts& skipped) {
  PingSamples samples = make_samples(settings);
  const int looks_log2 = settings.range.compression_log2;
  const int lines_per_block = EchoBlock::most_lines >> looks_log2;
  const int blocks = (samples.lines + lines_per_block - 1) / lines_per_block;
  std::atomic<int> next{0};
  std::mutex counting;
  workers.run(std::min(blocks, static_cast<int>(workers.size())), [&](int) {
    EchoBlock block(echo);
    Lines lines(ping, block);
    OutputLines output(settings, samples);
    for (int i = next++; i < blocks; i = next++) {
      const int begin = i * lines_per_block;
      const int end = std::min(begin + lines_per_block, samples.lines);
      block.load(begin << looks_log2, (end - begin) << looks_log2);
      for (int line = begin; line < end; ++line) {
        output.begin();
        for (int native = line << looks_log2; native < (line + 1) << looks_log2; ++native) {
          lines.add_native_line(native, output);
        }
        output.end(line);
      }
    }
    const std::lock_guard lock(counting);
    skipped += lines.skipped();
  });
  return samples;
}

}  // namespace

std::vector<float> tvg_amplitudes(const PhysicalModel& model, const RangeLines& range) {
  std::vector<float> amplitudes(static_cast<std::size_t>(range.count));
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    const double tvg_db =
        model.tvg_log_coefficient * std::log10(range_m) + 2 * model.tvg_absorption_db_per_m * range_m;
    amplitudes[k] =
        static_cast<float>(std::sqrt(decibels_to_power(std::min(tvg_db, model.tvg_max_db) + model.gain_db)));
  }
  return amplitudes;
}

ReceiverTables::ReceiverTables(const SonarSettings& settings)
    : aperture(settings.aperture),
      range(settings.range),
      model(settings.physical),
      sixteen_bit(settings.sixteen_bit),
      output_scale(settings.output_scale),
      filter(receive_kernel(aperture), aperture.beam_count()),
      response(model.range_cell_m, range.step_m),
      gain(tvg_amplitudes(model, range)),
      profile(noise_profile(settings)) {
  const float codes = codes_per_amplitude(settings);
  for (float& g : gain) {
    g *= codes;
  }
  if (model.noise) {
    noise = static_cast<float>(std::sqrt(decibels_to_power(model.noise_level_db)));
  }
  if (model.side_lobe_floor_db < 0) {
    leak = static_cast<float>(decibels_to_power(model.side_lobe_floor_db));
  }
}

bool ReceiverTables::fits(const SonarSettings& settings) const {
  return aperture == settings.aperture && range == settings.range && model == settings.physical &&
         sixteen_bit == settings.sixteen_bit && output_scale == settings.output_scale;
}

void Receiver::advance_speckle(const PingRequest& request, Stream& state) {
  const PhysicalModel& model = request.settings.physical;
  const bool kept = model.speckle == Speckle::ou || model.speckle == Speckle::frozen;
  if (state.kind != model.speckle || state.seed != request.seed || state.grain != state.tables.filter) {
    state.kind = model.speckle;
    state.seed = request.seed;
    state.grain = state.tables.filter;
    state.speckle = SpeckleField(kept ? request.settings.aperture.beam_count() : 0);
    state.T_world_sonar = request.T_world_sonar;
  }
  if (kept) {
    state.speckle.ensure_lines(request.settings.range.count);
  }
  if (model.speckle == Speckle::ou) {
    // docs/physics.md 2.8: correlation falls with the motion since the last ping, over half the aperture and
    // half a beam.
    const double moved = glm::length(request.T_world_sonar.position_m - state.T_world_sonar.position_m) /
                         (model.aperture_m / 2);
    const glm::dquat turn =
        glm::conjugate(state.T_world_sonar.orientation) * request.T_world_sonar.orientation;
    const double turned = 2 * std::asin(std::min(1.0, glm::length(glm::dvec3(turn.x, turn.y, turn.z)))) /
                          (request.settings.aperture.receive_beamwidth_rad / 2);
    state.speckle.fade(moved * moved + turned * turned);
  }
  state.T_world_sonar = request.T_world_sonar;
}

namespace {

struct PhysicalPing {
  const ReceiverTables& tables;
  SpeckleField& speckle;
  RandomKey speckle_key, noise_key;
  const SkipSwitches& skip;
};

/// Mode `physical`, line by line.
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

struct PaperPing {
  PaperModel model;
  RandomKey key;
  float codes = 0;  ///< per amplitude
  const SkipSwitches& skip;
};

SONARD_SIMD_CLONES
void speckle_row(const float* __restrict gaussian, float mean, float scale, bool folded, float floor,
                 int beams, float* __restrict value) {
  for (int b = 0; b < beams; ++b) {
    const float n = mean + scale * gaussian[b];
    value[b] = std::max(value[b] * (folded ? std::abs(n) : std::max(0.0F, n)), floor);
  }
}

SONARD_SIMD_CLONES
void clamp_row(float gain, float codes, int beams, float* __restrict value) {
  for (int b = 0; b < beams; ++b) {
    value[b] = std::min(1.0F, value[b] * gain) * codes;
  }
}

/// Mode `paper`, line by line: I * n, then gain with a clamp (docs/physics.md 1.1, 1.2 A8, A9).
class PaperLines {
 public:
  PaperLines(const PaperPing& ping, const EchoBlock& block)
      : ping_(ping),
        block_(block),
        beams_(block.beams()),
        random_((beams_ + 1) / 2),
        value_(static_cast<std::size_t>(beams_)) {}

  void add_native_line(int native, OutputLines& output) {
    const PaperModel& model = ping_.model;
    if (!(model.speckle_floor > 0) && !(block_.strongest(native) > 0) &&
        ping_.skip.on(SkipRule::lines_without_echo)) {
      skipped_.add(SkipRule::lines_without_echo);
      return;
    }
    std::copy_n(block_.line(native), beams_, value_.data());
    if (model.speckle != PaperModel::Speckle::off) {
      random_.draw(ping_.key, native);
      // Both parts of a complex number are used, each of variance 1/2: beams in the first half of the row get
      // real parts, the others imaginary ones.
      speckle_row(random_.real(), static_cast<float>(model.speckle_mean),
                  static_cast<float>(std::sqrt(2.0) * model.speckle_sd),
                  model.speckle == PaperModel::Speckle::folded_gaussian,
                  static_cast<float>(model.speckle_floor), beams_, value_.data());
    }
    clamp_row(static_cast<float>(2 * model.gain), ping_.codes, beams_, value_.data());
    output.add(value_.data());
  }

  const SkipCounts& skipped() const { return skipped_; }

 private:
  const PaperPing& ping_;
  const EchoBlock& block_;
  int beams_;
  ComplexRow random_;
  AlignedVector<float> value_;
  SkipCounts skipped_;
};

}  // namespace

PingSamples Receiver::receive(const EchoImage& echo, const PingRequest& request, int stream,
                              WorkerPool& workers) {
  const SonarSettings& settings = request.settings;
  skipped_ = {};
  const auto key = [&](RandomField field, std::uint64_t ping_number) {
    return make_random_key(request.seed, stream, field, ping_number);
  };
  if (settings.model == Model::paper) {
    const PaperPing ping{settings.paper, key(RandomField::paper_speckle, request.ping_number),
                         codes_per_amplitude(settings), skip_};
    return receive_lines<PaperLines>(echo, ping, settings, workers, skipped_);
  }
  Stream& state = streams_[stream];
  if (state.tables.fits(settings) && skip_.on(SkipRule::unchanged_settings)) {
    skipped_.add(SkipRule::unchanged_settings);
  } else {
    state.tables = ReceiverTables(settings);
  }
  advance_speckle(request, state);
  const EchoImage* heard = &echo;
  if (state.tables.response.taps() > 0) {
    state.tables.response.apply(echo, state.spread);
    heard = &state.spread;
  }
  // Frozen speckle belongs to the seed alone, so it is the same whenever a line is first drawn.
  const std::uint64_t speckle_ping = state.kind == Speckle::frozen ? 0 : request.ping_number;
  const PhysicalPing ping{state.tables, state.speckle, key(RandomField::speckle, speckle_ping),
                          key(RandomField::noise, request.ping_number), skip_};
  return receive_lines<PhysicalLines>(*heard, ping, settings, workers, skipped_);
}

}  // namespace sonard::render
