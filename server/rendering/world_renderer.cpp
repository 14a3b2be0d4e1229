// SPDX-License-Identifier: Apache-2.0
#include "server/rendering/world_renderer.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <spdlog/spdlog.h>

#include "renderer/pipeline/engine_trial.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"

namespace sonard::server {
namespace {

class WorldRenderer final : public PingRenderer {
 public:
  WorldRenderer(const render::World& world, const render::RendererOptions& options)
      : renderer_(world, options), automatic_(options.engine == render::EngineKind::automatic) {}

  std::string description() const override { return renderer_.engine_description(); }

  bool set_body_pose(const std::string& body, const render::Pose& T_world_body) override {
    return renderer_.set_body_pose(body, T_world_body);
  }

  render::PingSamples render_ping(const render::PingRequest& request, int stream) override {
    return renderer_.render_ping(request, stream);
  }

  void warm_up(const std::vector<render::StreamPing>& first_pings) override {
    if (automatic_) {
      spdlog::info("engine auto: {}", describe(render::choose_engine(renderer_, first_pings)));
      return;
    }
    for (const render::StreamPing& ping : first_pings) {
      // The receiver, which keeps speckle from ping to ping, needs no warming.
      renderer_.render_echo(ping.request, ping.stream);
    }
  }

  void begin_pings(const std::vector<render::StreamPing>& pings) override { renderer_.begin_pings(pings); }

  render::PingStatistics last_statistics() const override { return renderer_.last_statistics(); }

 private:
  render::SonarRenderer renderer_;
  const bool automatic_;
};

}  // namespace

RendererFactory world_renderer_factory(const render::World& world, render::RendererOptions options) {
  return [&world, options = std::move(options)] {
    const render::SelfTestResult tested = render::run_self_test(options);
    spdlog::info("renderer self-test passed: error={:.2f}% engine=\"{}\"", 100.0 * tested.error,
                 tested.engine);
    return std::make_unique<WorldRenderer>(world, options);
  };
}

}  // namespace sonard::server
