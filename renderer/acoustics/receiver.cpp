#include "renderer/acoustics/receiver.hpp"

#include "renderer/acoustics/output_lines.hpp"
#include "renderer/acoustics/paper_lines.hpp"
#include "renderer/acoustics/physical_lines.hpp"
#include "renderer/acoustics/random.hpp"

namespace sonard::render {

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
  state.fields.advance(request, state.tables);
  // Frozen speckle belongs to the seed alone, so it is the same whenever a line is first drawn.
  const bool frozen = settings.physical.speckle == PhysicalModel::Speckle::frozen;
  const std::uint64_t speckle_ping = frozen ? 0 : request.ping_number;
  const PhysicalPing ping{state.tables,
                          state.fields.speckle(key(RandomField::speckle, speckle_ping), skip_, skipped_),
                          state.fields.texture(key(RandomField::texture, speckle_ping), skip_, skipped_),
                          {.key = key(RandomField::noise, request.ping_number)},
                          draw_interference(settings.physical.interference, settings.range.count,
                                            key(RandomField::interference, request.ping_number)),
                          skip_};
  return receive_physical(echo, ping, settings, workers, skipped_);
}

}  // namespace sonard::render
