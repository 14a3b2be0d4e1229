// SPDX-License-Identifier: Apache-2.0
// `sonarview ping360`.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "clients/sonarview/common/ping_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/ping360/options.hpp"
#include "clients/sonarview/ping360/sweeps.hpp"
#include "protocol/ping360/client.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::client {
namespace {

constexpr double degrees_per_rad = 180.0 / std::numbers::pi;

SweepForm form_of(const Ping360Options& options) {
  constexpr double gradian_rad = 2.0 * std::numbers::pi / ping360::gradians_per_turn;
  picture::SweepShape shape;
  shape.step = picture::turn_units(options.scan.num_steps * gradian_rad);
  if (!options.all_round) {
    const int span = ping360::wrapped(options.scan.stop_angle - options.scan.start_angle);
    shape.left = picture::turn_bearing(ping360::bearing_rad(options.scan.start_angle, options.ahead));
    shape.width = picture::turn_units(span * gradian_rad);
  }
  shape.bins = options.scan.number_of_samples;
  shape.bin_m = options.bin_m();
  return {.title = "Ping360",
          .lines = "pings",
          .shape = shape,
          .sector = !options.all_round,
          .radius_px = options.run.radius_px};
}

/// The first request of a scan whose pings are requested one by one.
ping360::Transducer first_order(const ping360::AutoTransmit& scan) {
  ping360::Transducer order;
  ping360::copy_ping_settings(order, scan);
  order.angle = scan.start_angle;
  return order;
}

class Viewer final : public PingViewer<ping360::Client, ping360::ReceivedPing> {
 public:
  explicit Viewer(const Ping360Options& options)
      : PingViewer(options.run, options.line, "a Ping360"),
        options_(options),
        sweeps_(options.all_round, options.ahead),
        pictures_(form_of(options), options.run.every) {}

 private:
  void begin(TimePoint at) override;
  void take_ping(const ping360::ReceivedPing& ping) override;
  std::optional<std::string> identity() const override;
  void refresh_pictures(ImageWriter& to) override { pictures_.refresh(to, sweeps_.current()); }
  void finish_pictures(ImageWriter& to) override { pictures_.finish(to, sweeps_.current()); }
  std::string progress_text(std::uint64_t fresh) const override;
  bool sum_up(const RunCounters& counters) override;

  void log_ping(const ping360::ReceivedPing& ping) const;

  const Ping360Options options_;
  SweepCollector sweeps_;
  SweepPictures pictures_;
  std::uint64_t sweeps_done_ = 0;
};

void Viewer::begin(TimePoint at) {
  const ping360::AutoTransmit& scan = options_.scan;
  fmt::print(
      "scan range_m={:.3f} samples={} bin_m={:.5f} sample_period={} step={} start={} stop={} auto={}\n",
      scan.number_of_samples * options_.bin_m(), scan.number_of_samples, options_.bin_m(), scan.sample_period,
      scan.num_steps, scan.start_angle, scan.stop_angle, options_.automatic ? 1 : 0);
  std::fflush(stdout);
  if (options_.automatic) {
    client_.start(at, scan, options_.run.pings);
  } else {
    client_.start(at, first_order(scan), scan.num_steps, options_.run.pings);
  }
  open_line(options_.line);
}

void Viewer::take_ping(const ping360::ReceivedPing& ping) {
  count_ping(ping.received);
  if (options_.run.log_pings) {
    log_ping(ping);
  }
  const auto done = sweeps_.add(ping);
  if (!done) {
    return;
  }
  ++sweeps_done_;
  if (ImageWriter* const to = writer()) {
    pictures_.write(*to, *done);
  }
  if (options_.turns > 0 && sweeps_done_ >= options_.turns) {
    stop();
  }
}

void Viewer::log_ping(const ping360::ReceivedPing& ping) const {
  const auto strongest = std::max_element(ping.samples.begin(), ping.samples.end());
  fmt::print(
      "ping number={} turn={} angle={} bearing_deg={:.5g} samples={} strongest={} strongest_m={:.3f} "
      "crc32={:08x}\n",
      ping.number, sweeps_.current().number, ping.form.settings.angle,
      ping360::bearing_rad(ping.form.settings.angle, options_.ahead) * degrees_per_rad, ping.samples.size(),
      ping.samples.empty() ? 0 : *strongest,
      (static_cast<double>(strongest - ping.samples.begin()) + 0.5) * options_.bin_m(),
      crc32_of(ping.samples));
  std::fflush(stdout);
}

// ---- Messages

std::optional<std::string> Viewer::identity() const {
  const auto& information = client_.head().information;
  if (!information) {
    return std::nullopt;
  }
  return fmt::format("head at {}, device type {}, firmware {}.{}.{}", line_text(), information->device_type,
                     information->firmware_major, information->firmware_minor, information->firmware_patch);
}

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; turn {} has {} pings", pings(), fresh,
                     sweeps_.current().number, sweeps_.current().lines.size());
}

bool Viewer::sum_up(const RunCounters& counters) {
  const ping360::ClientStatistics& client = client_.statistics();
  fmt::print(
      "summary turns={} pings={} rate_hz={:.2f} commands={} timeouts={} pings_unwanted={} reconnects={} "
      "frames={} frames_bad={} bytes_dropped={} images_written={} images_skipped={}\n",
      sweeps_done_, counters.pings, counters.rate_hz, client.commands, client.timeouts, client.pings_unwanted,
      counters.reconnects, client.frames, client.bad_frames, client.dropped_bytes, counters.images_written,
      counters.images_skipped);
  return counters.pings > 0;
}

constexpr const char* summary = "Client for a Ping360: scans, reports the rate, writes pictures.";

constexpr const char* footer = R"(Examples:
  sonarview ping360 --udp 127.0.0.1:12345 --range 10 --out out     all round, ping by ping, until Ctrl-C
  sonarview ping360 --udp 127.0.0.1:12345 --auto --turns 1         one turn, scanned by the head itself
  sonarview ping360 --tty /dev/ttyUSB0 --sector -45 45 --step 2    back and forth over 90 degrees ahead

Exit status: 0 pings arrived; 1 a file could not be written; 2 invalid command line; 3 no head;
4 the head refuses, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<Ping360Arguments>(app);
  return [arguments] { return [options = arguments->options()] { return Viewer(options).run(); }; };
}

}  // namespace

const Subcommand& ping360_subcommand() {
  static constexpr Subcommand subcommand{"ping360", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
