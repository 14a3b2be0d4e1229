// SPDX-License-Identifier: Apache-2.0
// A renderer without GL. The samples of a ping follow from its number by a simple formula that tests can use.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/rendering/render_service.hpp"

namespace sonard::test {

/// Records the requests to a FakeRenderer and sets its behaviour. Shared with the test, which may read it
/// during a run.
struct FakeRendererControl {
  /// Called before each ping on the render thread; may throw or block.
  std::function<void(const render::PingRequest&, int head)> before_ping;
  /// Called for each warm-up ping on the render thread; may throw.
  std::function<void(const render::PingRequest&, int head)> warming_up;
  std::string engine = "fake";  ///< PingRenderer::description(); change it on the render thread only
  /// Streams of each call of begin_pings(); read it only after the service has ended.
  std::vector<std::vector<int>> begun;
  std::atomic<int> attempts{0};   ///< pings requested
  std::atomic<int> pings{0};      ///< pings rendered
  std::atomic<int> forgotten{0};  ///< calls of forget()
  std::atomic<bool> destroyed{false};

  void record(const render::PingRequest& request) {
    const std::lock_guard lock(mutex);
    requests.push_back(request);
  }
  void record_body(const std::string& name, const render::Pose& T_world_body) {
    const std::lock_guard lock(mutex);
    bodies.push_back(name);
    body_poses[name] = T_world_body;
  }
  /// The last pose of a body.
  render::Pose pose_of_body(const std::string& name) const {
    const std::lock_guard lock(mutex);
    return body_poses.at(name);
  }
  std::vector<render::PingRequest> recorded() const {
    const std::lock_guard lock(mutex);
    return requests;
  }
  std::vector<std::string> moved_bodies() const {
    const std::lock_guard lock(mutex);
    return bodies;
  }

 private:
  mutable std::mutex mutex;
  std::vector<render::PingRequest> requests;
  std::vector<std::string> bodies;
  std::map<std::string, render::Pose> body_poses;
};

/// The sample at (line, beam) of a ping.
inline std::uint8_t fake_sample(std::uint64_t ping_number, int line, int beam) {
  return static_cast<std::uint8_t>(7 * ping_number + 3 * static_cast<std::uint64_t>(line) +
                                   static_cast<std::uint64_t>(beam));
}

/// The ranges of a ping grow from port to starboard and from the lowest row up, from ping to ping, too.
inline render::DirectionEchoes fake_directions(const render::PingRequest& request) {
  const render::DirectionGrid& grid = request.settings.directions;
  render::DirectionEchoes echoes{grid.columns, grid.rows, {}, {}};
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      echoes.range_m.push_back(1.0F +
                               0.01F * static_cast<float>(fake_sample(request.ping_number, row, column)));
      echoes.intensity.push_back(1e-4F / echoes.range_m.back());
    }
  }
  return echoes;
}

class FakeRenderer final : public server::PingRenderer {
 public:
  explicit FakeRenderer(std::shared_ptr<FakeRendererControl> control) : control_(std::move(control)) {}
  ~FakeRenderer() override { control_->destroyed = true; }

  std::string description() const override { return control_->engine; }
  bool set_body_pose(const std::string& body, const render::Pose& T_world_body) override {
    control_->record_body(body, T_world_body);
    return true;
  }

  void forget(int) override { ++control_->forgotten; }

  render::PingSamples render_ping(const render::PingRequest& request, int head) override {
    ++control_->attempts;
    if (control_->before_ping) {
      control_->before_ping(request, head);
    }
    control_->record(request);
    render::PingSamples samples;
    if (request.settings.directions.any()) {
      samples.directions = fake_directions(request);
      ++control_->pings;
      return samples;
    }
    samples.beams = request.settings.aperture.beam_count();
    samples.bins = request.settings.range.output_count();
    for (int line = 0; line < samples.bins; ++line) {
      for (int beam = 0; beam < samples.beams; ++beam) {
        const std::uint8_t value = fake_sample(request.ping_number, line, beam);
        if (request.settings.sixteen_bit) {
          samples.u16.push_back(static_cast<std::uint16_t>(value << 8 | value));
        } else {
          samples.u8.push_back(value);
        }
      }
    }
    ++control_->pings;
    return samples;
  }

  void warm_up(const std::vector<render::HeadRequest>& first_pings) override {
    for (const render::HeadRequest& ping : first_pings) {
      if (control_->warming_up) {
        control_->warming_up(ping.request, ping.head);
      }
    }
  }

  bool begins_pings() const override { return true; }
  void begin_pings(const std::vector<render::HeadRequest>& pings) override {
    std::vector<int>& heads = control_->begun.emplace_back();
    for (const render::HeadRequest& ping : pings) {
      heads.push_back(ping.head);
    }
  }

  render::PingStatistics last_statistics() const override { return {}; }

 private:
  std::shared_ptr<FakeRendererControl> control_;
};

inline server::RendererFactory fake_renderer_factory(std::shared_ptr<FakeRendererControl> control) {
  return [control] { return std::make_unique<FakeRenderer>(control); };
}

}  // namespace sonard::test
