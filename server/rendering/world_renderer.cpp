// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/world_renderer.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "renderer/errors.hpp"
#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "server/rendering/engine_choice_file.hpp"

namespace sonard::server {
namespace {

class WorldRenderer final : public PingRenderer {
 public:
  WorldRenderer(const render::World& world, const render::RendererOptions& options,
                std::filesystem::path choices)
      : world_(world), options_(options), choices_(std::move(choices)), renderer_(world, options) {}

  std::string description() const override { return renderer_.engine_description(); }

  bool set_body_pose(const std::string& body, const render::Pose& T_world_body) override {
    return renderer_.set_body_pose(body, T_world_body);
  }

  render::PingSamples render_ping(const render::PingRequest& request, int head) override {
    return renderer_.render_ping(request, head);
  }

  void forget(int head) override { renderer_.forget(head); }

  void warm_up(const std::vector<render::HeadRequest>& first_pings) override {
    if (options_.engine == render::EngineKind::automatic && measure_engines(first_pings)) {
      return;
    }
    for (const render::HeadRequest& ping : first_pings) {
      // The receiver keeps speckle from ping to ping and needs no warm-up.
      renderer_.render_echo(ping.request, ping.head);
    }
  }

  bool begins_pings() const override { return renderer_.engine() == render::EngineKind::gpu; }
  void begin_pings(const std::vector<render::HeadRequest>& pings) override { renderer_.begin_pings(pings); }

  render::PingStatistics last_statistics() const override { return renderer_.last_statistics(); }

 private:
  /// Measures both engines, unless an earlier start has. @return true if pings were rendered
  bool measure_engines(const std::vector<render::HeadRequest>& first_pings) {
    const std::string situation = situation_of(options_, world_, first_pings);
    if (const std::optional<KeptChoice> kept = choices_.find(situation); kept && take(*kept)) {
      return false;
    }
    const render::EngineTrial trial = render::choose_engine_at_start(renderer_, first_pings, options_.gpu);
    spdlog::info("engine auto: {}", describe(trial));
    // A GPU that is unavailable is looked for again: that takes no time, and a driver may be installed.
    if (!trial.gpu.empty()) {
      choices_.keep(situation, {trial.taken, describe(trial)});
    }
    return trial.software_gl.empty();
  }

  /// @return false if that engine is no longer available
  bool take(const KeptChoice& kept) {
    try {
      renderer_.use_engine(kept.taken);
    } catch (const render::RendererError&) {
      return false;
    }
    spdlog::info("engine auto: {} is taken, as an earlier start measured: {} (kept in {})",
                 name_of(kept.taken), kept.measured, choices_.path().string());
    return true;
  }

  const render::World& world_;
  const render::RendererOptions options_;
  const EngineChoiceFile choices_;
  render::SonarRenderer renderer_;
};

}  // namespace

RendererFactory world_renderer_factory(const render::World& world, render::RendererOptions options,
                                       std::filesystem::path choices) {
  return [&world, options = std::move(options), choices = std::move(choices)] {
    const render::SelfTestResult tested = render::run_self_test(options);
    spdlog::info("engine: self-test passed error={:.2f}% engine=\"{}\"", 100.0 * tested.error, tested.engine);
    return std::make_unique<WorldRenderer>(world, options, choices);
  };
}

}  // namespace sonard::server
