// SPDX-License-Identifier: Apache-2.0
// The array's beams from fine beams, against the sum over its elements.
#include "renderer/acoustics/beam_pattern.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double gemini_half_rad = pi / 3;
const RandomKey key = make_random_key(1, 0, RandomField::array_elements, 0);

Aperture gemini(int fine_beams) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(256, gemini_half_rad);
  aperture.azimuth = Aperture::Azimuth::array;
  aperture.fine_beams = fine_beams;
  return aperture;
}

Aperture with_errors(Aperture aperture) {
  aperture.element_amplitude_sd = 0.45;
  aperture.element_phase_sd_rad = 0.45;
  return aperture;
}

/// Pattern, dB, of 155 half-wave elements under a Hamming taper: 1 degree wide (docs/physics.md 2.8).
double hamming_db(double sine_offset) {
  constexpr int elements = 155;
  double sum = 0;
  double total = 0;
  for (int i = 0; i < elements; ++i) {
    const double weight = 0.54 - 0.46 * std::cos(2 * pi * i / (elements - 1));
    sum += weight * std::cos(pi * (i - 77) * sine_offset);
    total += weight;
  }
  return 20 * std::log10(std::abs(sum / total) + 1e-15);
}

EchoImage image_of(int beams, int lines, float value) {
  return {beams, lines,
          std::vector<float>(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines), value)};
}

EchoImage heard(const BeamPattern& pattern, const EchoImage& fine, SkipSwitches skip = {},
                unsigned threads = 2) {
  WorkerPool workers(threads);
  SkipCounts skipped;
  EchoImage out;
  pattern.apply(fine, out, workers, skip, skipped);
  return out;
}

double db(float power) {
  return 10 * std::log10(static_cast<double>(power) + 1e-30);
}

// A point in the middle of a fine beam, anywhere in the fan: the array's pattern to 0.1 dB down to -30 dB.
TEST(BeamPattern, APointIsHeardWithThePatternOfTheArray) {
  for (const int fine_beams : {1, 2, 3}) {
    const Aperture aperture = gemini(fine_beams);
    const BeamPattern pattern(aperture, key);
    ASSERT_EQ(pattern.fine_beams(), 256 * fine_beams);
    for (const int beam : {20, 128, 250}) {
      const int target = beam * fine_beams;
      EchoImage fine = image_of(pattern.fine_beams(), 7, 0.0F);
      fine.intensity[static_cast<std::size_t>(target * 7 + 3)] = 5.0F;
      const EchoImage out = heard(pattern, fine);
      const double spacing = 2 * std::sin(gemini_half_rad) / 256;
      // Sine of the target's bearing, re the middle of its beam.
      const double target_offset = -spacing / 2 + spacing / fine_beams / 2;
      const double level = db(out.at(beam, 3)) - hamming_db(target_offset);
      int compared = 0;
      for (int b = 0; b < 256; ++b) {
        const double truth = hamming_db((b - beam) * spacing - target_offset);
        if (truth > -30) {
          EXPECT_NEAR(db(out.at(b, 3)) - level, truth, 0.1) << b;
          ++compared;
        } else if (std::abs(b - beam) > 4) {
          EXPECT_EQ(out.at(b, 3), 0.0F) << "nothing leaks of elements without errors";
        }
        EXPECT_EQ(out.at(b, 2), 0.0F);
      }
      EXPECT_GE(compared, 6);
    }
  }
}

// docs/physics.md 2.5: an echo that fills the fan evenly in angle keeps its level in every beam, with any
// beams, taper and errors.
TEST(BeamPattern, AnEvenEchoKeepsItsLevel) {
  std::vector<Aperture> apertures{gemini(1), gemini(2), with_errors(gemini(2))};
  Aperture wide = gemini(2);  // each beam seven times as wide as the array's
  wide.beam_edges_rad = equal_angle_edges(17, 2.0);
  apertures.push_back(wide);
  Aperture untapered = with_errors(gemini(1));
  untapered.taper = Aperture::Taper::uniform;
  apertures.push_back(untapered);
  for (const Aperture& aperture : apertures) {
    const BeamPattern pattern(aperture, key);
    const std::vector<double> edges = fine_beam_edges(aperture);
    EchoImage fine = image_of(pattern.fine_beams(), 3, 0.0F);
    for (std::size_t f = 0; f + 1 < edges.size(); ++f) {
      fine.intensity[3 * f + 1] = static_cast<float>(edges[f] - edges[f + 1]);
    }
    const EchoImage out = heard(pattern, fine, SkipSwitches::none());
    for (int b = 0; b < aperture.beam_count(); ++b) {
      const auto beam = static_cast<std::size_t>(b);
      EXPECT_NEAR(static_cast<double>(out.at(b, 1)) /
                      (aperture.beam_edges_rad[beam] - aperture.beam_edges_rad[beam + 1]),
                  1, 1e-5);
    }
  }
}

// A beam's share of a far echo is the mean power of the errors, re its own main lobe, which keeps exp(-sd^2)
// of its power.
TEST(BeamPattern, ErrorsOfTheElementsLeakIntoAllBeams) {
  const double floor = (1 + 0.45 * 0.45 - std::exp(-0.45 * 0.45)) * 1.3628 / 154.5;
  const double main_lobe = std::exp(-0.45 * 0.45);
  constexpr int arrays = 40;
  double mean = 0;
  for (int seed = 0; seed < arrays; ++seed) {
    const RandomKey elements =
        make_random_key(static_cast<std::uint64_t>(seed), 0, RandomField::array_elements, 0);
    const BeamPattern pattern(with_errors(gemini(1)), elements);
    EchoImage fine = image_of(256, 1, 0.0F);
    fine.intensity[100] = 1.0F;
    const EchoImage out = heard(pattern, fine);
    EXPECT_NEAR(db(out.at(30, 0)), db(out.at(230, 0)), 0.15);
    mean += (db(out.at(160, 0)) - db(out.at(100, 0))) / arrays;
  }
  // The main lobes of single arrays are some 0.6 dB off.
  EXPECT_NEAR(mean, 10 * std::log10(floor / main_lobe), 0.3);
}

// Lines without echo, with an uneven echo and with an even one.
EchoImage some_echo(int beams, int lines) {
  EchoImage image = image_of(beams, lines, 0.0F);
  for (int b = 0; b < beams; ++b) {
    for (int k = 40; k < lines; ++k) {
      image.intensity[static_cast<std::size_t>(b * lines + k)] =
          k < 100 ? 1e-6F * static_cast<float>((b * 7919 + k * 104729) % 1009) : 1e-5F;
    }
  }
  return image;
}

TEST(BeamPattern, IsTheWeightedSumOfFineBeamsForAnyNumberOfThreads) {
  const BeamPattern pattern(with_errors(gemini(2)), key);
  const EchoImage fine = some_echo(512, 133);
  const EchoImage out = heard(pattern, fine, SkipSwitches::none(), 1);
  EXPECT_EQ(out.intensity, heard(pattern, fine, SkipSwitches::none(), 3).intensity);
  for (const int beam : {0, 77, 255}) {
    for (const int line : {0, 39, 40, 99, 132}) {
      double sum = 0;
      for (int f = 0; f < 512; ++f) {
        sum += pattern.share(beam, f) * static_cast<double>(fine.at(f, line));
      }
      EXPECT_NEAR(static_cast<double>(out.at(beam, line)), sum, 1e-5 * sum);
    }
  }
}

TEST(BeamPattern, FineBeamsDivideTheirBeams) {
  Aperture aperture = gemini(3);
  const std::vector<double> fine = fine_beam_edges(aperture);
  ASSERT_EQ(fine.size(), 256u * 3 + 1);
  for (std::size_t i = 0; i < fine.size(); ++i) {
    EXPECT_NEAR(std::sin(fine[i]), std::sin(gemini_half_rad) * (1 - 2.0 * static_cast<double>(i) / 768),
                1e-12);
  }
  for (std::size_t b = 0; b < aperture.beam_edges_rad.size(); ++b) {
    EXPECT_EQ(fine[3 * b], aperture.beam_edges_rad[b]);
  }
}

}  // namespace
}  // namespace sonard::render
