// SPDX-License-Identifier: Apache-2.0
// Images of a Gemini as a client receives them: the head's job gives the settings, the head sends the
// samples, and a client assembles the image. There are no sockets, so nothing is lost.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <utility>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/client.hpp"
#include "protocol/gemini/device.hpp"
#include "protocol/gemini/ping_settings.hpp"
#include "renderer/acoustics/receiver.hpp"
#include "renderer/ping.hpp"
#include "server/devices/gemini/settings.hpp"
#include "server/devices/gemini/type.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/addresses.hpp"

namespace sonard::test {

struct GeminiImage {
  int lines = 0;
  double line_m = 0;
  std::vector<double> codes;  ///< [line * gemini::beam_count + beam], 8 or 16 bits

  double at(int line, int beam) const {
    return codes[static_cast<std::size_t>(line * gemini::beam_count + beam)];
  }
};

class GeminiClient {
 public:
  /// Replaces the renderer: returns samples for a request with settings and the numbers of the ping.
  using Render = std::function<render::PingSamples(const render::PingRequest&)>;

  GeminiClient(server::HeadConfig head, const gemini::PingConfig& config, Render render)
      : head_(std::move(head)),
        device_(device_config(), now_),
        client_(gemini::ClientConfig{}),
        config_(config),
        render_(std::move(render)) {}

  render::Pose T_world_sonar;
  std::uint64_t seed = 7;

  std::vector<GeminiImage> images(int pings) {
    using namespace std::chrono_literals;
    std::vector<GeminiImage> images;
    client_.start(now_, config_, static_cast<std::uint64_t>(pings));
    const TimePoint begin = now_;
    while (!client_.finished() && now_ < begin + 1000s) {
      step();
      for (const gemini::ReceivedPing& ping : client_.take_pings()) {
        EXPECT_TRUE(ping.complete());
        images.push_back({ping.lines, line_m_, {}});
        std::vector<double>& codes = images.back().codes;
        codes.assign(ping.samples.u8.begin(), ping.samples.u8.end());
        codes.insert(codes.end(), ping.samples.u16.begin(), ping.samples.u16.end());
      }
    }
    EXPECT_EQ(images.size(), static_cast<std::size_t>(pings));
    return images;
  }

 private:
  static gemini::DeviceConfig device_config() {
    gemini::DeviceConfig config;
    config.alternate_address = head_address;
    config.netmask = 0xFF000000;
    return config;
  }

  void step() {
    happen(TimePassed{});
    client_.advance(now_);
    for (const auto& datagram : client_.take_outgoing()) {
      happen(BytesReceived{{0, {client_address, 52900}, head_address}, SharedBytes(datagram.bytes)});
    }
    now_ += std::chrono::microseconds(200);
  }

  void happen(const Event& event) {
    const Actions actions = device_.step(now_, event);
    for (const Outgoing& datagram : actions.send) {
      client_.on_datagram(now_, datagram.bytes);
    }
    if (actions.render) {
      happen(PingRendered{image_of(*actions.render)});
    }
  }

  PingImage image_of(const PingJob& job) {
    render::PingRequest request;
    request.T_world_sonar = T_world_sonar;
    request.settings = server::gemini_sonar_settings(job, head_);
    request.ping_number = job.number;
    request.seed = seed;
    line_m_ = job.bin_m();
    render::PingSamples samples = render_(request);
    return {job.number, std::move(samples.u8), std::move(samples.u16)};
  }

  static constexpr Ipv4 head_address = 0x7F000002;
  static constexpr Ipv4 client_address = 0x7F000001;

  server::HeadConfig head_;
  TimePoint now_{};
  gemini::Device device_;
  gemini::Client client_;
  gemini::PingConfig config_;
  Render render_;
  double line_m_ = 0;
};

/// Replaces the renderer by the receiver alone: all beams and lines have the same mean echo.
class EvenEcho {
 public:
  explicit EvenEcho(float intensity) : intensity_(intensity) {}

  render::PingSamples operator()(const render::PingRequest& request) {
    const int beams = request.settings.aperture.beam_count();
    const int lines = request.settings.range.count;
    const render::EchoImage echo{
        beams, lines,
        std::vector<float>(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines), intensity_)};
    return state_->receiver.receive(echo, request, 0, state_->workers);
  }

 private:
  struct State {
    render::Receiver receiver;
    render::WorkerPool workers{2};
  };
  float intensity_;
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace sonard::test
