// SPDX-License-Identifier: Apache-2.0
// `sonarview ping1d`.
#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "clients/sonarview/common/ping_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/ping1d/options.hpp"
#include "clients/sonarview/ping1d/waterfall.hpp"
#include "common/text/printable.hpp"
#include "protocol/ping1d/client.hpp"

namespace sonard::client {
namespace {

class Viewer final : public PingViewer<ping1d::Client, ping1d::ReceivedPing> {
 public:
  explicit Viewer(const Ping1dOptions& options)
      : PingViewer(options.run, options.line, "a Ping1D"),
        options_(options),
        waterfall_(options.run.radius_px) {}

 private:
  void begin(TimePoint at) override;
  void take_ping(const ping1d::ReceivedPing& ping) override;
  std::optional<std::string> identity() const override;
  void refresh_pictures(ImageWriter& to) override;
  void finish_pictures(ImageWriter& to) override;
  std::string progress_text(std::uint64_t fresh) const override;
  bool sum_up(const RunCounters& counters) override;

  std::vector<Picture> pictures(const std::string& name) const;

  const Ping1dOptions options_;
  Waterfall waterfall_;
  ping1d::Distance newest_;
};

void Viewer::begin(TimePoint at) {
  client_.start(at, options_.settings, options_.run.pings);
  open_line(options_.line);
}

void Viewer::take_ping(const ping1d::ReceivedPing& ping) {
  count_ping(ping.received);
  newest_ = ping.measured;
  waterfall_.add(ping);
  if (options_.run.log_pings) {
    fmt::print(
        "ping number={} distance_m={:.3f} confidence={} start_m={:.3f} length_m={:.3f} gain={} points={} "
        "crc32={:08x}\n",
        newest_.ping_number, 1e-3 * newest_.distance_mm, newest_.confidence_percent,
        1e-3 * newest_.scan_start_mm, 1e-3 * newest_.scan_length_mm, newest_.gain_setting,
        ping.profile.size(), crc32_of(ping.profile));
    std::fflush(stdout);
  }
  if (ImageWriter* const to = writer();
      to != nullptr && options_.run.every > 0 && pings() % options_.run.every == 0) {
    to->write(pictures(fmt::format("{:06}", pings())));
  }
}

// ---- Pictures

std::vector<Picture> Viewer::pictures(const std::string& name) const {
  const auto shown = std::make_shared<const Waterfall>(waterfall_);
  return {{fmt::format("waterfall-{}.png", name), [shown] { return shown->draw(); }},
          {fmt::format("profiles-{}.png", name), [shown] { return shown->samples(); }}};
}

void Viewer::refresh_pictures(ImageWriter& to) {
  if (!waterfall_.empty()) {
    to.refresh(pictures("last"));
  }
}

void Viewer::finish_pictures(ImageWriter& to) {
  if (!waterfall_.empty()) {
    to.write(pictures("last"));
  }
}

// ---- Messages

std::optional<std::string> Viewer::identity() const {
  const auto& information = client_.information();
  if (!information) {
    return std::nullopt;
  }
  return fmt::format("{} at {}, firmware {}.{}.{}", information->device_revision == 2 ? "Ping2" : "Ping1D",
                     line_text(), information->firmware_major, information->firmware_minor,
                     information->firmware_patch);
}

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; {}", pings(), fresh, measurement_text(newest_));
}

bool Viewer::sum_up(const RunCounters& counters) {
  const ping1d::ClientStatistics& client = client_.statistics();
  fmt::print(
      "summary pings={} rate_hz={:.2f} distance_m={:.3f} confidence={} pings_missed={} timeouts={} "
      "reconnects={} frames={} frames_bad={} bytes_dropped={} images_written={} images_skipped={}\n",
      counters.pings, counters.rate_hz, 1e-3 * newest_.distance_mm, newest_.confidence_percent,
      client.pings_missed, client.timeouts, counters.reconnects, client.frames, client.bad_frames,
      client.dropped_bytes, counters.images_written, counters.images_skipped);
  return counters.pings > 0;
}

constexpr const char* summary = "Client for a Ping1D or Ping2: shows distance and profiles, writes pictures.";

constexpr const char* footer = R"(Examples:
  sonarview ping1d --udp 127.0.0.1:9090 --out out                     range and gain chosen by the head
  sonarview ping1d --udp 127.0.0.1:9090 --range 20 --gain 3 --pings 100 --log-pings
  sonarview ping1d --tty /dev/ttyUSB0 --interval 50                   20 pings per second

Exit status: 0 pings arrived; 1 a file could not be written; 2 invalid command line; 3 no head;
4 the head refuses, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<Ping1dArguments>(app);
  return [arguments] { return [options = arguments->options()] { return Viewer(options).run(); }; };
}

}  // namespace

const Subcommand& ping1d_subcommand() {
  static constexpr Subcommand subcommand{"ping1d", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
