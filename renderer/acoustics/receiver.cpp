#include "renderer/acoustics/receiver.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/output_lines.hpp"
#include "renderer/acoustics/paper_lines.hpp"
#include "renderer/acoustics/physical_lines.hpp"
#include "renderer/acoustics/random.hpp"

namespace sonard::render {

using Speckle = PhysicalModel::Speckle;

void Receiver::advance_speckle(const PingRequest& request, Stream& state) {
  const PhysicalModel& model = request.settings.physical;
  const bool kept = model.speckle == Speckle::ou || model.speckle == Speckle::frozen;
  const ReceiverTables& tables = state.tables;
  if (state.kind != model.speckle || state.seed != request.seed || state.grain != tables.filter ||
      state.range_grain != tables.range_grain) {
    state.kind = model.speckle;
    state.seed = request.seed;
    state.grain = tables.filter;
    state.range_grain = tables.range_grain;
    state.speckle = SpeckleField(kept ? request.settings.aperture.beam_count() : 0);
    state.texture = state.speckle;
    state.T_world_sonar = request.T_world_sonar;
  }
  if (kept) {
    const int lines = request.settings.range.count + 2 * tables.range_grain.reach();
    state.speckle.ensure_lines(lines);
    state.texture.ensure_lines(model.texture_nu > 0 ? lines : 0);
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
    state.texture.fade(moved * moved + turned * turned);
  }
  state.T_world_sonar = request.T_world_sonar;
}

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
    return receive_paper(echo, ping, settings, workers, skipped_);
  }
  Stream& state = streams_[stream];
  if (state.tables.fits(settings) && skip_.on(SkipRule::unchanged_settings)) {
    skipped_.add(SkipRule::unchanged_settings);
  } else {
    state.tables = ReceiverTables(settings);
  }
  advance_speckle(request, state);
  // Frozen speckle belongs to the seed alone, so it is the same whenever a line is first drawn.
  const std::uint64_t speckle_ping = state.kind == Speckle::frozen ? 0 : request.ping_number;
  const bool kept = state.kind == Speckle::ou || state.kind == Speckle::frozen;
  const bool textured = settings.physical.texture_nu > 0;
  const PhysicalPing ping{
      state.tables,
      {key(RandomField::speckle, speckle_ping), kept ? &state.speckle : nullptr},
      {key(RandomField::texture, speckle_ping), kept && textured ? &state.texture : nullptr},
      {key(RandomField::noise, request.ping_number), nullptr},
      draw_interference(settings.physical.interference, settings.range.count,
                        key(RandomField::interference, request.ping_number)),
      skip_};
  return receive_physical(echo, ping, settings, workers, skipped_);
}

}  // namespace sonard::render
