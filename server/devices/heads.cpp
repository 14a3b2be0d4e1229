#include "server/devices/heads.hpp"

#include <variant>

#include "protocol/gemini/ping_plan.hpp"
#include "protocol/micron/line_job.hpp"
#include "protocol/micron/units.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "server/devices/gemini_head.hpp"
#include "server/devices/gemini_settings.hpp"
#include "server/devices/micron_head.hpp"
#include "server/devices/micron_settings.hpp"

namespace sonard::server {
namespace {

render::SonarSettings usual(const GeminiHeadConfig& head) {
  gemini::PingConfig config;
  config.end_range = 2411;  // 20 m at 1500 m/s
  config.range_compression = 1;
  return to_sonar_settings(gemini::plan_ping(config, head.device)->job, head);
}

render::SonarSettings usual(const MicronHeadConfig& head) {
  return to_sonar_settings(micron::make_line_job(micron::HeadCommand{}, head.device, micron::bearing_ahead),
                           head);
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

render::SonarSettings usual_settings(const AnyHeadConfig& config) {
  return std::visit([](const auto& head) { return usual(head); }, config);
}

void check_sampling_of(const AnyHeadConfig& config) {
  const render::SonarSettings settings = usual_settings(config);
  if (render::needs_grid(settings)) {
    render::make_sample_grid(settings.aperture, settings.sampling, render::grid_options(settings));
  }
}

}  // namespace sonard::server
