// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_rendering.hpp"

#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/devices/device_type.hpp"

namespace sonard::server {

HeadRendering::HeadRendering(const HeadConfig& config, int head, RenderService& renderer, const Clock& clock,
                             const Options& options)
    : config_(config),
      head_(head),
      renderer_(renderer),
      clock_(clock),
      options_(options),
      load_(usual_settings(config), config.adaptive_quality) {}

void HeadRendering::submit(PosedPing ping, std::chrono::nanoseconds period, RenderService::Done done) {
  submitted_ = true;
  if (options_.adapts) {
    load_.submitted(clock_.now(), period);
    ping.request.settings.sampling.preset = load_.preset();
  }
  renderer_.submit(std::move(ping), std::move(done));
}

bool HeadRendering::take(const RenderResult& result) {
  submitted_ = false;
  if (const auto news = load_.answered(clock_.now())) {
    spdlog::log(news->level == Notice::Level::warning ? spdlog::level::warn : spdlog::level::info,
                "head={}: {}", config_.name, news->text);
  }
  if (result.error.empty()) {
    ++counters_.pings_rendered;
    const render::StageSeconds& spent = result.statistics.seconds;
    counters_.render_seconds +=
        spent.visibility + spent.binning + spent.azimuth_pattern + spent.pulse + spent.receiver;
    counters_.stages += spent;
    counters_.skipped += result.statistics.skipped;
    newest_ = spent;
    return true;
  }
  if (result.error != last_error_) {
    last_error_ = result.error;
    errors_.error("head={}: cannot render: {}", config_.name, result.error);
  }
  return false;
}

bool HeadRendering::withdraw() {
  if (!options_.withdraws || !renderer_.withdraw(head_)) {
    return false;
  }
  submitted_ = false;
  load_.withdrawn();
  counters_.skipped.add(render::SkipRule::nobody_listening);
  return true;
}

void log_skipped(const std::string& head, const render::SkipCounts& skipped) {
  std::string text;
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    if (const std::uint64_t count = skipped.of(entry.rule); count > 0) {
      text += fmt::format(" {}={}", entry.name, count);
    }
  }
  if (!text.empty()) {
    spdlog::debug("head={}: skipped{}", head, text);
  }
}

double mean_render_ms(const RenderCounters& before, const RenderCounters& now) {
  const std::uint64_t rendered = now.pings_rendered - before.pings_rendered;
  return rendered > 0 ? 1e3 * (now.render_seconds - before.render_seconds) / static_cast<double>(rendered)
                      : 0.0;
}

}  // namespace sonard::server
