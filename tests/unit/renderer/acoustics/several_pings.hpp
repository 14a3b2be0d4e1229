// SPDX-License-Identifier: Apache-2.0
// The same pings for every version of array, pulse and receiver.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

/// 16 bit samples of three pings of a moving sonar with all effects on, and of one in mode `paper`. Odd sizes
/// leave remainders at every vector length.
template <class Receiver, class PointSpread, class PingRequest, class EchoImage, class WorkerPool>
std::vector<std::uint16_t> several_pings() {
  constexpr int beams = 203;
  constexpr int lines = 331;
  EchoImage echo{beams, lines, {}};
  for (int i = 0; i < beams * lines; ++i) {
    const int line = i % lines;
    echo.intensity.push_back(line % 7 == 0 ? 0.0F : 1e-6F * static_cast<float>(1 + i % 1009));
  }
  PingRequest request;
  for (int i = 0; i <= beams; ++i) {
    request.settings.aperture.beam_edges_rad.push_back(1 - 2.0 * i / beams);
  }
  request.settings.range = {lines, 0.02, 0, false};
  request.settings.aperture.azimuth = decltype(request.settings.aperture.azimuth)::array;
  request.settings.aperture.fine_beams = 1;
  request.settings.aperture.element_phase_sd_rad = 0.4;
  request.settings.physical.pulse.shape = decltype(request.settings.physical.pulse.shape)::chirp;
  request.settings.physical.pulse.range_cell_m = 0.03;
  request.settings.physical.noise.level_db = -100;
  request.settings.physical.speckle.texture_nu = 1.5;
  request.settings.physical.speckle.texture_range_m = 3;
  request.settings.physical.ring_down.on = true;
  request.settings.physical.noise.interference.probability = 1;
  request.settings.sixteen_bit = true;
  WorkerPool workers(1);
  Receiver receiver;
  PointSpread reception;
  auto skipped = receiver.skipped();  // its counts are not used
  reception.prepare(request.settings, 1, 0, {}, skipped);
  EchoImage heard;
  reception.form_beams(echo, request.settings, heard, workers, {}, skipped);
  reception.spread(heard, workers);
  std::swap(echo, heard);
  std::vector<std::uint16_t> all;
  const auto add_ping = [&] {
    const std::vector<std::uint16_t> samples = receiver.receive(echo, request, 0, workers).u16;
    all.insert(all.end(), samples.begin(), samples.end());
    ++request.ping_number;
    request.T_world_sonar.position_m.x += 0.02;
  };
  add_ping();
  add_ping();
  request.settings.range.compression_log2 = 1;
  add_ping();
  request.settings.model = decltype(request.settings.model)::paper;
  for (float& intensity : echo.intensity) {
    intensity = std::fmod(1000 * intensity, 1.0F);
  }
  add_ping();
  return all;
}
