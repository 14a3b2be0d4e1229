#include "renderer/acoustics/receiver.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/beam_kernel.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr int lines_per_job =
    32;  // output lines; small enough to share evenly, large enough for whole cache lines

double decibels_to_power(double decibels) {
  return std::pow(10.0, decibels / 10);
}

/// Real and imaginary part side by side.
struct ComplexRow {
  std::vector<float> real, imaginary;
  explicit ComplexRow(int width)
      : real(static_cast<std::size_t>(width)), imaginary(static_cast<std::size_t>(width)) {}
};

/// out[b] = sum_j kernel[j] in[b + j].
SONARD_SIMD_CLONES
void filter_row(const float* in, const float* kernel, int taps, int beams, float* out) {
  for (int b = 0; b < beams; ++b) {
    out[b] = kernel[0] * in[b];
  }
  for (int j = 1; j < taps; ++j) {
    for (int b = 0; b < beams; ++b) {
      out[b] += kernel[j] * in[b + j];
    }
  }
}

/// Envelope of echo plus noise; both fields come filtered.
SONARD_SIMD_CLONES
void envelope_row(const float* echo, const float* speckle_re, const float* speckle_im,
                  const float* noise_scale, const float* noise_re, const float* noise_im, float noise,
                  float gain, int beams, float* out) {
  for (int b = 0; b < beams; ++b) {
    const float amplitude = std::sqrt(echo[b]);
    const float n = noise * noise_scale[b];
    const float re = amplitude * speckle_re[b] + n * noise_re[b];
    const float im = amplitude * speckle_im[b] + n * noise_im[b];
    out[b] = gain * std::sqrt(re * re + im * im);
  }
}

SONARD_SIMD_CLONES
void evolve_row(const float* innovation, float keep, float fresh, int width, float* state) {
  for (int i = 0; i < width; ++i) {
    state[i] = keep * state[i] + fresh * innovation[i];
  }
}

/// Native lines go in, output lines are written when complete.
class OutputLines {
 public:
  OutputLines(const SonarSettings& settings, int beams, PingSamples& samples)
      : settings_(settings), beams_(beams), sum_(static_cast<std::size_t>(beams)), samples_(samples) {}

  void begin() { std::fill(sum_.begin(), sum_.end(), 0.0F); }

  void add(const float* amplitude) {
    if (settings_.range.compression_peak) {
      for (std::size_t b = 0; b < sum_.size(); ++b) {
        sum_[b] = std::max(sum_[b], amplitude[b]);
      }
    } else {
      for (std::size_t b = 0; b < sum_.size(); ++b) {
        sum_[b] += amplitude[b];
      }
    }
  }

  /// Quantises last, rounding to nearest and clamping: nothing wraps.
  void end(int line) {
    const float looks =
        settings_.range.compression_peak ? 1.0F : static_cast<float>(1 << settings_.range.compression_log2);
    const std::size_t at = static_cast<std::size_t>(line) * static_cast<std::size_t>(beams_);
    for (std::size_t b = 0; b < sum_.size(); ++b) {
      const float amplitude = sum_[b] / looks;
      if (settings_.sixteen_bit) {
        samples_.u16[at + b] = static_cast<std::uint16_t>(std::min(65535.0F, amplitude * 65535.0F + 0.5F));
      } else {
        samples_.u8[at + b] = static_cast<std::uint8_t>(std::min(255.0F, amplitude * 255.0F + 0.5F));
      }
    }
  }

 private:
  const SonarSettings& settings_;
  int beams_;
  std::vector<float> sum_;
  PingSamples& samples_;
};

PingSamples make_samples(const SonarSettings& settings) {
  PingSamples samples;
  samples.beams = settings.aperture.beam_count();
  samples.lines = settings.range.output_count();
  const std::size_t size = static_cast<std::size_t>(samples.beams) * static_cast<std::size_t>(samples.lines);
  settings.sixteen_bit ? samples.u16.resize(size) : samples.u8.resize(size);
  return samples;
}

/// The echo of one native line, beam after beam. What leaks through the side lobes is measured against the
/// strongest echo of the line (docs/physics.md 2.16), so it is modelled so.
void gather_line(const EchoImage& echo, int line, float leak, float* out) {
  float strongest = 0;
  for (int b = 0; b < echo.beams; ++b) {
    out[b] = echo.at(b, line);
    strongest = std::max(strongest, out[b]);
  }
  for (int b = 0; b < echo.beams; ++b) {
    out[b] += leak * strongest;
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

/// How the white field under the speckle is to be had for this ping.
struct Receiver::SpeckleStep {
  SpeckleField* field = nullptr;  ///< null: draw it afresh from `base`
  int known_lines = 0;            ///< lines of the field that hold an earlier ping
  float keep = 1.0F;              ///< weight of the old field
  RandomKey base, innovation;

  /// White field of one line. Each line is asked for once per ping, by one thread.
  void draw(int line, ComplexRow& row) const {
    const int width = static_cast<int>(row.real.size());
    const auto key_row = static_cast<std::uint32_t>(line);
    if (field == nullptr) {
      fill_complex_gaussian(base, key_row, width, row.real.data(), row.imaginary.data());
      return;
    }
    float* real = &field->real[static_cast<std::size_t>(line) * row.real.size()];
    float* imaginary = &field->imaginary[static_cast<std::size_t>(line) * row.real.size()];
    if (line >= known_lines) {
      fill_complex_gaussian(base, key_row, width, real, imaginary);
    } else if (keep < 1.0F) {
      const float fresh = std::sqrt(1 - keep * keep);
      fill_complex_gaussian(innovation, key_row, width, row.real.data(), row.imaginary.data());
      evolve_row(row.real.data(), keep, fresh, width, real);
      evolve_row(row.imaginary.data(), keep, fresh, width, imaginary);
    }
    std::copy_n(real, width, row.real.data());
    std::copy_n(imaginary, width, row.imaginary.data());
  }
};

Receiver::SpeckleStep Receiver::advance_speckle(const PingRequest& request, int stream, int width) {
  using Speckle = PhysicalModel::Speckle;
  const PhysicalModel& model = request.settings.physical;
  SpeckleStep step;
  const bool per_ping = model.speckle == Speckle::per_ping;
  step.base = make_random_key(request.seed, stream, RandomField::speckle_base,
                              per_ping ? request.ping_number + 1 : 0);
  if (model.speckle != Speckle::ou) {
    speckle_.erase(stream);
    return step;
  }
  SpeckleField& field = speckle_[stream];
  if (field.width != width || field.seed != request.seed) {
    field = {};
    field.width = width;
    field.seed = request.seed;
    field.T_world_sonar = request.T_world_sonar;
  }
  // docs/physics.md 2.8: correlation falls with the motion since the last ping, over half the aperture and
  // half a beam.
  const double moved =
      glm::length(request.T_world_sonar.position_m - field.T_world_sonar.position_m) / (model.aperture_m / 2);
  const glm::dquat turn = glm::conjugate(field.T_world_sonar.orientation) * request.T_world_sonar.orientation;
  const double turned = 2 * std::asin(std::min(1.0, glm::length(glm::dvec3(turn.x, turn.y, turn.z)))) /
                        (request.settings.aperture.receive_beamwidth_rad / 2);
  step.keep = static_cast<float>(std::exp(-moved * moved - turned * turned));
  step.innovation =
      make_random_key(request.seed, stream, RandomField::speckle_innovation, request.ping_number);
  step.known_lines = std::min(field.lines, request.settings.range.count);
  field.lines = request.settings.range.count;
  field.T_world_sonar = request.T_world_sonar;
  const std::size_t size = static_cast<std::size_t>(field.lines) * static_cast<std::size_t>(width);
  field.real.resize(size);
  field.imaginary.resize(size);
  step.field = &field;
  return step;
}

namespace {

/// Mode `paper`: I * n, then gain with a clamp (docs/physics.md 1.1, 1.2 A8, A9).
PingSamples receive_paper(const EchoImage& echo, const PingRequest& request, int stream,
                          WorkerPool& workers) {
  using Speckle = PaperModel::Speckle;
  const SonarSettings& settings = request.settings;
  const PaperModel& model = settings.paper;
  PingSamples samples = make_samples(settings);
  const RandomKey key =
      make_random_key(request.seed, stream, RandomField::paper_speckle, request.ping_number);
  const int looks = 1 << settings.range.compression_log2;
  const auto scale =
      static_cast<float>(std::sqrt(2.0) * model.speckle_sd);  // CN(0, 1) has variance 1/2 per part
  workers.run((samples.lines + lines_per_job - 1) / lines_per_job, [&](int job) {
    OutputLines output(settings, samples.beams, samples);
    ComplexRow random(samples.beams);
    std::vector<float> value(static_cast<std::size_t>(samples.beams));
    for (int line = job * lines_per_job; line < std::min(samples.lines, (job + 1) * lines_per_job); ++line) {
      output.begin();
      for (int native = line * looks; native < (line + 1) * looks; ++native) {
        gather_line(echo, native, 0.0F, value.data());
        if (model.speckle != Speckle::off) {
          fill_complex_gaussian(key, static_cast<std::uint32_t>(native), samples.beams, random.real.data(),
                                random.imaginary.data());
          for (std::size_t b = 0; b < value.size(); ++b) {
            const float n = static_cast<float>(model.speckle_mean) + scale * random.real[b];
            const float factor = model.speckle == Speckle::folded_gaussian ? std::abs(n) : std::max(0.0F, n);
            value[b] = std::max(value[b] * factor, static_cast<float>(model.speckle_floor));
          }
        }
        for (float& v : value) {
          v = std::min(1.0F, v * static_cast<float>(2 * model.gain));
        }
        output.add(value.data());
      }
      output.end(line);
    }
  });
  return samples;
}

}  // namespace

PingSamples Receiver::receive(const EchoImage& echo, const PingRequest& request, int stream,
                              WorkerPool& workers) {
  const SonarSettings& settings = request.settings;
  if (settings.model == Model::paper) {
    return receive_paper(echo, request, stream, workers);
  }
  const PhysicalModel& model = settings.physical;
  PingSamples samples = make_samples(settings);
  const int beams = samples.beams;
  const std::vector<float> kernel = receive_kernel(settings.aperture);
  const int taps = static_cast<int>(kernel.size());
  const int width = beams + taps - 1;
  const bool speckled = model.speckle != PhysicalModel::Speckle::off;
  const SpeckleStep speckle = advance_speckle(request, stream, width);
  const RandomKey noise_key = make_random_key(request.seed, stream, RandomField::noise, request.ping_number);
  const std::vector<float> gain = tvg_amplitudes(model, settings.range);
  const std::vector<float> profile = noise_profile(settings);
  const auto noise =
      model.noise ? static_cast<float>(std::sqrt(decibels_to_power(model.noise_level_db))) : 0.0F;
  const auto leak =
      model.side_lobe_floor_db < 0 ? static_cast<float>(decibels_to_power(model.side_lobe_floor_db)) : 0.0F;
  const int looks = 1 << settings.range.compression_log2;

  workers.run((samples.lines + lines_per_job - 1) / lines_per_job, [&](int job) {
    OutputLines output(settings, beams, samples);
    ComplexRow white(width);
    ComplexRow speckle_row(beams);
    ComplexRow noise_row(beams);
    // Without speckle the echo is a constant phasor.
    std::fill(speckle_row.real.begin(), speckle_row.real.end(), 1.0F);
    std::vector<float> line_echo(static_cast<std::size_t>(beams));
    std::vector<float> envelope(static_cast<std::size_t>(beams));
    for (int line = job * lines_per_job; line < std::min(samples.lines, (job + 1) * lines_per_job); ++line) {
      output.begin();
      for (int native = line * looks; native < (line + 1) * looks; ++native) {
        if (speckled) {
          speckle.draw(native,
                       white);  // also where the output is blanked: every line of the field must stay current
          filter_row(white.real.data(), kernel.data(), taps, beams, speckle_row.real.data());
          filter_row(white.imaginary.data(), kernel.data(), taps, beams, speckle_row.imaginary.data());
        }
        if ((native + 0.5) * settings.range.step_m < model.near_field_blank_m) {
          continue;
        }
        gather_line(echo, native, leak, line_echo.data());
        if (model.noise) {
          fill_complex_gaussian(noise_key, static_cast<std::uint32_t>(native), width, white.real.data(),
                                white.imaginary.data());
          filter_row(white.real.data(), kernel.data(), taps, beams, noise_row.real.data());
          filter_row(white.imaginary.data(), kernel.data(), taps, beams, noise_row.imaginary.data());
        }
        envelope_row(line_echo.data(), speckle_row.real.data(), speckle_row.imaginary.data(), profile.data(),
                     noise_row.real.data(), noise_row.imaginary.data(), noise,
                     gain[static_cast<std::size_t>(native)], beams, envelope.data());
        output.add(envelope.data());
      }
      output.end(line);
    }
  });
  return samples;
}

}  // namespace sonard::render
