// SPDX-License-Identifier: Apache-2.0
// Rules of the receiver: each on against off, with equal pings and seeds. The expected counts follow from the
// echo below.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/acoustics/receiver.hpp"

namespace sonard::render {
namespace {

constexpr int lines = 100;
constexpr int first_echo = 20;
constexpr int lines_with_echo = 30;

/// Echo in the lines [first_echo, first_echo + lines_with_echo), different in every beam.
EchoImage echo_of(int beams) {
  EchoImage echo{beams, lines, std::vector<float>(static_cast<std::size_t>(beams) * lines, 0.0F)};
  for (int beam = 0; beam < beams; ++beam) {
    for (int line = first_echo; line < first_echo + lines_with_echo; ++line) {
      echo.intensity[static_cast<std::size_t>(beam * lines + line)] =
          0.01F * static_cast<float>(1 + beam % 5) * static_cast<float>(line);
    }
  }
  return echo;
}

PingRequest request_of(int beams, double fan_rad = 2.0) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(beams, fan_rad);
  request.settings.range = {lines, 0.01, 0, false};
  PhysicalModel& model = request.settings.physical;
  model.noise.level_db = -30;
  model.tvg.log_coefficient = 0;
  model.tvg.absorption_db_per_m = 0;
  model.gain_db = 0;
  model.near_field_blank_m = 0;
  request.settings.sixteen_bit = true;
  request.seed = 3;
  return request;
}

struct Outcome {
  std::vector<std::vector<std::uint16_t>> pings;
  std::uint64_t skipped = 0;  ///< by the rule, in the last ping
};

/// Two pings with the sonar at rest.
Outcome two_pings(SkipRule rule, const SkipSwitches& skip, PingRequest request) {
  WorkerPool workers(2);
  Receiver receiver(skip);
  Outcome outcome;
  const EchoImage echo = echo_of(request.settings.aperture.beam_count());
  for (request.ping_number = 1; request.ping_number <= 2; ++request.ping_number) {
    outcome.pings.push_back(receiver.receive(echo, request, 0, workers).u16);
    outcome.skipped = receiver.skipped().of(rule);
  }
  return outcome;
}

/// Compares the rule on with off. The rule must have skipped `expected` times in the second ping.
void expect_within_bound(SkipRule rule, const PingRequest& request, std::uint64_t expected) {
  ASSERT_EQ(entry_of(rule).bound_unit, entry_of(rule).bound == 1 ? "output code" : "output codes");
  const Outcome on = two_pings(rule, {}, request);
  EXPECT_EQ(on.skipped, expected);
  EXPECT_GT(*std::max_element(on.pings[1].begin(), on.pings[1].end()), 1000) << "there is something to hear";
  const Outcome off = two_pings(rule, SkipSwitches{}.turn_off(rule), request);
  EXPECT_EQ(off.skipped, 0u);
  for (std::size_t ping = 0; ping < on.pings.size(); ++ping) {
    ASSERT_EQ(on.pings[ping].size(), off.pings[ping].size());
    int worst = 0;
    for (std::size_t i = 0; i < on.pings[ping].size(); ++i) {
      worst = std::max(worst, std::abs(on.pings[ping][i] - off.pings[ping][i]));
    }
    EXPECT_LE(worst, entry_of(rule).bound) << "ping " << ping;
  }
}

TEST(ReceiverRules, LinesWithoutEchoGetNoSpeckle) {
  expect_within_bound(SkipRule::bins_without_echo, request_of(64), lines - lines_with_echo);
}

TEST(ReceiverRules, LinesWithoutEchoGetNoSpeckleInThePaperEither) {
  PingRequest request = request_of(64);
  request.settings.model = Model::paper;
  request.settings.paper.speckle = PaperModel::Speckle::folded_gaussian;
  expect_within_bound(SkipRule::bins_without_echo, request, lines - lines_with_echo);
  // A floor is present without an echo too.
  request.settings.paper.speckle_floor = 0.03;
  expect_within_bound(SkipRule::bins_without_echo, request, 0);
}

TEST(ReceiverRules, NearFieldIsNotWorkedOut) {
  PingRequest request = request_of(64);
  request.settings.physical.near_field_blank_m = 0.3;  // echo in ten of these lines
  expect_within_bound(SkipRule::blanked_near_field, request, 30);
}

TEST(ReceiverRules, NoiseOfAmplitudeZeroIsNotDrawn) {
  PingRequest request = request_of(64);
  expect_within_bound(SkipRule::no_noise, request, 0);
  request.settings.physical.noise.on = false;
  expect_within_bound(SkipRule::no_noise, request, lines);
}

TEST(ReceiverRules, SpeckleOfASonarAtRestIsKept) {
  for (const auto speckle : {SpeckleSettings::Kind::ou, SpeckleSettings::Kind::frozen}) {
    PingRequest request = request_of(64);
    request.settings.physical.speckle.kind = speckle;
    expect_within_bound(SkipRule::unmoved_speckle, request, lines_with_echo);
  }
  PingRequest request = request_of(64);
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  expect_within_bound(SkipRule::unmoved_speckle, request, 0);
}

TEST(ReceiverRules, SpeckleOfAMovingSonarIsNot) {
  WorkerPool workers(1);
  Receiver receiver;
  PingRequest request = request_of(64);
  receiver.receive(echo_of(64), request, 0, workers);
  request.T_world_sonar.position_m.x += 1e-3;
  receiver.receive(echo_of(64), request, 0, workers);
  EXPECT_EQ(receiver.skipped().of(SkipRule::unmoved_speckle), 0u);
}

// Speckle `per_ping`: a row of it for every line with an echo, and one of noise for every line.
TEST(ReceiverRules, BeamsThatShareNothingAreNotFiltered) {
  PingRequest scanning = request_of(1, 0.05);
  scanning.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  // The noise of a single beam is drawn along the range at once.
  expect_within_bound(SkipRule::narrow_aperture, scanning, lines_with_echo);
  // 21 beams 5.5 degrees apart, each one degree wide; the odd number leaves one vector that is not full.
  PingRequest sparse = request_of(21, 2.0);
  sparse.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  expect_within_bound(SkipRule::narrow_aperture, sparse, lines + lines_with_echo);
  PingRequest dense = request_of(256, 2.0);
  expect_within_bound(SkipRule::narrow_aperture, dense, 0);
}

// A row of speckle for every line with an echo, and one of noise for every line.
TEST(ReceiverRules, LinesAsLongAsThePulseAreNotJoined) {
  PingRequest request = request_of(64);
  expect_within_bound(SkipRule::long_bins, request, lines + lines_with_echo);
  request.settings.physical.pulse.shape = PulseSettings::Shape::chirp;
  request.settings.physical.pulse.range_cell_m = 0.02;
  expect_within_bound(SkipRule::long_bins, request, 0);
}

// nu is 30 at 0.4 m and exceeds 20 beyond 0.267 m: in the lines with an echo, from 27 to 49.
TEST(ReceiverRules, ManyScatterersAreNotTextured) {
  PingRequest request = request_of(64);
  request.settings.physical.speckle.kind = SpeckleSettings::Kind::per_ping;
  request.settings.physical.noise.on = false;
  request.settings.physical.speckle.texture_nu = 30;
  request.settings.physical.speckle.texture_range_m = 0.4;
  EXPECT_EQ(two_pings(SkipRule::many_scatterers, {}, request).skipped, 23u);
  const SkipSwitches off = SkipSwitches{}.turn_off(SkipRule::many_scatterers);
  EXPECT_EQ(two_pings(SkipRule::many_scatterers, off, request).skipped, 0u);
  // Scintillation index of an even echo in the lines to which the rule applies.
  WorkerPool workers(2);
  const auto index = [&](const SkipSwitches& skip) {
    Receiver receiver(skip);
    EchoImage even = echo_of(64);
    std::fill(even.intensity.begin(), even.intensity.end(), 1e-3F);
    double n = 0, sum = 0, square = 0;
    for (request.ping_number = 0; request.ping_number < 400; ++request.ping_number) {
      const std::vector<std::uint16_t> codes = receiver.receive(even, request, 0, workers).u16;
      for (std::size_t i = 27 * 64; i < codes.size(); ++i, ++n) {
        const double intensity = static_cast<double>(codes[i]) * codes[i];
        sum += intensity;
        square += intensity * intensity;
      }
    }
    return square * n / (sum * sum) - 1;
  };
  const double with = index({});
  const double without = index(off);
  EXPECT_NEAR(with, 1, 0.01);
  EXPECT_GT(without, with);
  EXPECT_LE(without - with, entry_of(SkipRule::many_scatterers).bound);
}

// Lines of 1 cm: the ring-down ends behind the 60th.
TEST(ReceiverRules, RingDownIsNotFollowedBeyondItsEnd) {
  PingRequest request = request_of(64);
  request.settings.physical.noise.on = false;
  request.settings.physical.ring_down = {true, -3, 0.2, 0.6, 0};
  const Outcome on = two_pings(SkipRule::ring_down_over, {}, request);
  EXPECT_EQ(on.skipped, 40u);
  const Outcome off =
      two_pings(SkipRule::ring_down_over, SkipSwitches{}.turn_off(SkipRule::ring_down_over), request);
  EXPECT_EQ(off.skipped, 0u);
  int worst = 0;
  for (std::size_t i = 0; i < on.pings[1].size(); ++i) {
    worst = std::max(worst, std::abs(on.pings[1][i] - off.pings[1][i]));
  }
  const int highest = *std::max_element(on.pings[1].begin(), on.pings[1].end());
  EXPECT_GT(highest, 10'000);
  EXPECT_LE(worst, entry_of(SkipRule::ring_down_over).bound * highest);
}

TEST(ReceiverRules, PingsThatAreNotHitAreLeftAlone) {
  PingRequest request = request_of(64);
  expect_within_bound(SkipRule::no_interference, request, 0);  // there is no interference
  request.settings.physical.noise.interference.probability = 1e-12;
  expect_within_bound(SkipRule::no_interference, request, lines);
}

TEST(ReceiverRules, TablesAreMadeOnce) {
  const Outcome on = two_pings(SkipRule::unchanged_settings, {}, request_of(64));
  EXPECT_EQ(on.skipped, 1u);
  const Outcome off = two_pings(SkipRule::unchanged_settings,
                                SkipSwitches{}.turn_off(SkipRule::unchanged_settings), request_of(64));
  EXPECT_EQ(off.skipped, 0u);
  EXPECT_EQ(on.pings, off.pings);
}

TEST(ReceiverRules, AllOffTogetherTheImageIsTheSameToOneCode) {
  PingRequest request = request_of(64);
  request.settings.physical.near_field_blank_m = 0.3;
  const Outcome on = two_pings(SkipRule::bins_without_echo, {}, request);
  const Outcome off = two_pings(SkipRule::bins_without_echo, SkipSwitches::none(), request);
  for (std::size_t i = 0; i < on.pings[0].size(); ++i) {
    ASSERT_LE(std::abs(on.pings[0][i] - off.pings[0][i]), 1) << i;
  }
}

}  // namespace
}  // namespace sonard::render
