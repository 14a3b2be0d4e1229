#include "server/devices/heads.hpp"

#include <variant>

#include "renderer/visibility/sample_grid.hpp"
#include "server/devices/gemini_head.hpp"
#include "server/devices/gemini_settings.hpp"
#include "server/devices/micron_head.hpp"
#include "server/devices/micron_settings.hpp"

namespace sonard::server {
namespace {

render::SonarSettings any_ping_of(const GeminiHeadConfig& head) {
  return to_sonar_settings(gemini::PingJob{}, head);
}

render::SonarSettings any_ping_of(const MicronHeadConfig& head) {
  return to_sonar_settings(micron::MicronJob{}, head);
}

std::unique_ptr<Head> make(const GeminiHeadConfig& config, int stream, const HeadServices& services) {
  return std::make_unique<GeminiHead>(config, stream, services);
}

std::unique_ptr<Head> make(const MicronHeadConfig& config, int stream, const HeadServices& services) {
  return std::make_unique<MicronHead>(config, stream, services);
}

}  // namespace

std::unique_ptr<Head> make_head(const AnyHeadConfig& config, int stream, const HeadServices& services) {
  return std::visit([&](const auto& head) { return make(head, stream, services); }, config);
}

bool is_scanning(const AnyHeadConfig& config) {
  return std::holds_alternative<MicronHeadConfig>(config);
}

void check_sampling_of(const AnyHeadConfig& config) {
  const render::SonarSettings settings =
      std::visit([](const auto& head) { return any_ping_of(head); }, config);
  if (render::needs_grid(settings)) {
    render::make_sample_grid(settings.aperture, settings.sampling, render::grid_options(settings));
  }
}

}  // namespace sonard::server
