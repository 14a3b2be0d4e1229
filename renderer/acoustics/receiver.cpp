// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/receiver.hpp"

#include <limits>

#include "renderer/acoustics/paper_receiver.hpp"
#include "renderer/acoustics/physical_receiver.hpp"
#include "renderer/acoustics/quantizer.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/acoustics/ring_down.hpp"

namespace sonard::render {

namespace {

/// Frozen speckle depends on the seed alone, so it does not matter when a line is first drawn.
std::uint64_t speckle_ping(const PingRequest& request) {
  const bool frozen = request.settings.physical.speckle.kind == SpeckleSettings::Kind::frozen;
  return frozen ? 0 : request.ping_number;
}

/// The noise level of a single beam depends on its bearing.
float noise_factor_of(const PingRequest& request, int head) {
  const NoiseSettings& noise = request.settings.physical.noise;
  if (request.settings.aperture.beam_count() > 1 || noise.by_bearing_db == 0) {
    return 1.0F;
  }
  return noise_at_bearing(noise, ScanPose(request.T_world_sonar).bearing_rad,
                          make_random_key(request.seed, head, RandomField::noise_by_bearing, 0));
}

}  // namespace

Receiver::HeadState& Receiver::state_of(const SonarSettings& settings, int head) {
  HeadState& state = heads_[head];
  if (state.tables.fits(settings) && skip_.on(SkipRule::unchanged_settings)) {
    skipped_.add(SkipRule::unchanged_settings);
  } else {
    state.tables = ReceiverTables(settings);
  }
  return state;
}

RandomFieldOfPing Receiver::speckle_of(HeadState& state, const PingRequest& request, int head) {
  return state.fields.speckle(
      make_random_key(request.seed, head, RandomField::speckle, speckle_ping(request)), skip_, skipped_);
}

RandomFieldOfPing Receiver::texture_of(HeadState& state, const PingRequest& request, int head) {
  return state.fields.texture(
      make_random_key(request.seed, head, RandomField::texture, speckle_ping(request)), skip_, skipped_);
}

/// The noise of a single beam is drawn at once for all bins.
RandomFieldOfPing Receiver::noise_of(HeadState& state, RandomKey key) {
  const ReceiverTables& tables = state.tables;
  if (tables.filter.beams() > 1 || !tables.model.noise.on) {
    return {.key = key};
  }
  return {.key = key,
          .beam = draw_along_range(key, tables.range.count * tables.cells, tables.noise_correlation,
                                   state.white_noise, state.noise)};
}

PingSamples Receiver::receive(const EchoImage& echo, const PingRequest& request, int head,
                              WorkerPool& workers) {
  const SonarSettings& settings = request.settings;
  skipped_ = {};
  echo_over_floor_ = std::numeric_limits<double>::infinity();
  const auto key = [&](RandomField field) {
    return make_random_key(request.seed, head, field, request.ping_number);
  };
  if (settings.model == Model::paper) {
    const PaperReceiverInput ping{settings.paper, key(RandomField::paper_speckle),
                                  codes_per_amplitude(settings), skip_};
    return receive_paper(echo, ping, settings, workers, skipped_);
  }
  HeadState& state = state_of(settings, head);
  state.fields.advance(request, state.tables);
  const PhysicalReceiverInput ping{
      state.tables,
      speckle_of(state, request, head),
      texture_of(state, request, head),
      noise_of(state, key(RandomField::noise)),
      draw_interference(settings.physical.noise.interference, settings.range, key(RandomField::interference)),
      draw_ring_down(settings.physical.ring_down, key(RandomField::ring_down)),
      noise_factor_of(request, head),
      skip_};
  return receive_physical(echo, ping, settings, workers, skipped_, echo_over_floor_);
}

bool Receiver::pass(const PingRequest& request, int head, WorkerPool& workers) {
  skipped_ = {};
  const SonarSettings& settings = request.settings;
  if (settings.model == Model::paper || settings.physical.speckle.kind != SpeckleSettings::Kind::ou) {
    return true;  // no state between pings
  }
  HeadState& state = state_of(settings, head);
  const bool single_beam = settings.aperture.beam_count() == 1;
  if (!single_beam && state.tables.pulse_correlation.reach() == 0) {
    return false;
  }
  state.fields.advance(request, state.tables);
  const PhysicalReceiverInput ping{
      state.tables, speckle_of(state, request, head), texture_of(state, request, head), {}, {}, {}, {},
      skip_};
  evolve_fields(ping, workers, skipped_);
  return true;
}

}  // namespace sonard::render
