// SPDX-License-Identifier: Apache-2.0
// `sonarview ping360`.
#include <fmt/format.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "clients/sonarview/common/line_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/ping360/options.hpp"
#include "clients/sonarview/ping360/sweeps.hpp"
#include "protocol/ping360/client.hpp"
#include "protocol/ping360/units.hpp"

namespace sonard::client {
namespace {

constexpr std::chrono::milliseconds stop_patience{500};
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

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const Ping360Options& options)
      : LineViewer(options.run),
        options_(options),
        client_(started()),
        sweeps_(options.all_round, options.ahead),
        pictures_(form_of(options), options.run.every) {}

 private:
  void begin(TimePoint at) override;
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override { client_.on_bytes(at, bytes); }
  void talk(TimePoint at) override;
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  bool head_met() const override { return client_.statistics().frames > 0; }
  void take_received() override;
  bool finished() const override { return client_.finished(); }
  std::chrono::nanoseconds say_goodbye(TimePoint at) override;
  void refresh_pictures(ImageWriter& to) override { pictures_.refresh(to, sweeps_.current()); }
  void finish_pictures(ImageWriter& to) override { pictures_.finish(to, sweeps_.current()); }
  std::string progress_text(std::uint64_t fresh) const override;
  std::string awaited_text() const override;
  std::string no_head_text(double wait_s) const override;
  std::string no_ping_text(double wait_s) const override;
  bool sum_up(const RunCounters& counters) override;

  void take_ping(const ping360::ReceivedPing& ping);
  void log_ping(const ping360::ReceivedPing& ping) const;
  void greet_head();

  const Ping360Options options_;
  ping360::Client client_;
  SweepCollector sweeps_;
  SweepPictures pictures_;
  std::uint64_t sweeps_done_ = 0;
  bool greeted_ = false;
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

void Viewer::talk(TimePoint at) {
  client_.advance(at);
  for (const std::vector<std::uint8_t>& frame : client_.take_outgoing()) {
    send(frame);
  }
}

void Viewer::take_received() {
  greet_head();
  for (const ping360::ReceivedPing& ping : client_.take_pings()) {
    if (!stopping()) {
      take_ping(ping);
    }
  }
  if (const auto& refusal = client_.refusal(); refusal && !stopping()) {
    give_up(ExitStatus::incomplete, "the head refused a command: " + refusal->text);
  }
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
  boost::crc_32_type crc;
  crc.process_bytes(ping.samples.data(), ping.samples.size());
  fmt::print(
      "ping number={} turn={} angle={} bearing_deg={:.5g} samples={} strongest={} strongest_m={:.3f} "
      "crc32={:08x}\n",
      ping.number, sweeps_.current().number, ping.form.settings.angle,
      ping360::bearing_rad(ping.form.settings.angle, options_.ahead) * degrees_per_rad, ping.samples.size(),
      ping.samples.empty() ? 0 : *strongest,
      (static_cast<double>(strongest - ping.samples.begin()) + 0.5) * options_.bin_m(), crc.checksum());
  std::fflush(stdout);
}

/// Stops the scan, because a head continues without its client.
std::chrono::nanoseconds Viewer::say_goodbye(TimePoint at) {
  client_.stop(at);
  return head_met() ? stop_patience : std::chrono::milliseconds{};
}

// ---- Messages

void Viewer::greet_head() {
  const auto& information = client_.head().information;
  if (greeted_ || !information) {
    return;
  }
  greeted_ = true;
  say(fmt::format("head at {}, device type {}, firmware {}.{}.{}", options_.line.text(),
                  information->device_type, information->firmware_major, information->firmware_minor,
                  information->firmware_patch));
}

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; turn {} has {} pings", pings(), fresh,
                     sweeps_.current().number, sweeps_.current().lines.size());
}

std::string Viewer::awaited_text() const {
  return fmt::format("a head on {}", options_.line.text());
}

std::string Viewer::no_head_text(double wait_s) const {
  const std::uint64_t foreign = client_.statistics().dropped_bytes;
  return fmt::format("{} is open, but no head answered within {:.1f} s{}", options_.line.text(), wait_s,
                     foreign > 0 ? ": " + foreign_bytes_text(foreign, "a Ping360") : "");
}

std::string Viewer::no_ping_text(double wait_s) const {
  return fmt::format("no ping for {:.1f} s", wait_s);
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
