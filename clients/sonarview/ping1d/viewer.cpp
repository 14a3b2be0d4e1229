// SPDX-License-Identifier: Apache-2.0
// `sonarview ping1d`.
#include <fmt/format.h>

#include <boost/crc.hpp>
#include <cstdio>
#include <memory>
#include <string>

#include "clients/sonarview/common/line_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/ping1d/options.hpp"
#include "clients/sonarview/ping1d/waterfall.hpp"
#include "common/text/printable.hpp"
#include "protocol/ping1d/client.hpp"

namespace sonard::client {
namespace {

constexpr std::chrono::milliseconds stop_patience{500};

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const Ping1dOptions& options)
      : LineViewer(options.run), options_(options), client_(started()), waterfall_(options.run.radius_px) {}

 private:
  void begin(TimePoint at) override;
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override { client_.on_bytes(at, bytes); }
  void talk(TimePoint at) override;
  std::optional<TimePoint> next_deadline() const override { return client_.next_deadline(); }
  bool head_met() const override { return client_.statistics().frames > 0; }
  void take_received() override;
  bool finished() const override { return client_.finished(); }
  std::chrono::nanoseconds say_goodbye(TimePoint at) override;
  void refresh_pictures(ImageWriter& to) override;
  void finish_pictures(ImageWriter& to) override;
  std::string progress_text(std::uint64_t fresh) const override;
  std::string awaited_text() const override { return fmt::format("a head on {}", options_.line.text()); }
  std::string no_head_text(double wait_s) const override;
  std::string no_ping_text(double wait_s) const override {
    return fmt::format("no ping for {:.1f} s", wait_s);
  }
  bool sum_up(const RunCounters& counters) override;

  void take_ping(const ping1d::ReceivedPing& ping);
  void greet_head();
  std::vector<Picture> pictures(const std::string& name) const;

  const Ping1dOptions options_;
  ping1d::Client client_;
  Waterfall waterfall_;
  ping1d::Distance newest_;
  bool greeted_ = false;
};

void Viewer::begin(TimePoint at) {
  client_.start(at, options_.settings, options_.run.pings);
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
  for (const ping1d::ReceivedPing& ping : client_.take_pings()) {
    if (!stopping()) {
      take_ping(ping);
    }
  }
  if (const auto& refusal = client_.refusal(); refusal && !stopping()) {
    give_up(ExitStatus::incomplete, "the head refused a command: " + printable(refusal->text));
  }
}

void Viewer::take_ping(const ping1d::ReceivedPing& ping) {
  count_ping(ping.received);
  newest_ = ping.measured;
  waterfall_.add(ping);
  if (options_.run.log_pings) {
    boost::crc_32_type crc;
    crc.process_bytes(ping.profile.data(), ping.profile.size());
    fmt::print(
        "ping number={} distance_m={:.3f} confidence={} start_m={:.3f} length_m={:.3f} gain={} points={} "
        "crc32={:08x}\n",
        newest_.ping_number, 1e-3 * newest_.distance_mm, newest_.confidence_percent,
        1e-3 * newest_.scan_start_mm, 1e-3 * newest_.scan_length_mm, newest_.gain_setting,
        ping.profile.size(), crc.checksum());
    std::fflush(stdout);
  }
  if (ImageWriter* const to = writer();
      to != nullptr && options_.run.every > 0 && pings() % options_.run.every == 0) {
    to->write(pictures(fmt::format("{:06}", pings())));
  }
}

/// Ends the stream, because a head on a serial line continues without its client.
std::chrono::nanoseconds Viewer::say_goodbye(TimePoint at) {
  client_.stop(at);
  return head_met() ? stop_patience : std::chrono::milliseconds{};
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

void Viewer::greet_head() {
  const auto& information = client_.information();
  if (greeted_ || options_.run.quiet || !information) {
    return;
  }
  greeted_ = true;
  fmt::print(stderr, "sonarview: {} at {}, firmware {}.{}.{}\n",
             information->device_revision == 2 ? "Ping2" : "Ping1D", printable(options_.line.text()),
             information->firmware_major, information->firmware_minor, information->firmware_patch);
}

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; {}", pings(), fresh, measurement_text(newest_));
}

std::string Viewer::no_head_text(double wait_s) const {
  const std::uint64_t foreign = client_.statistics().dropped_bytes;
  return fmt::format("{} is open, but no head answered within {:.1f} s{}", options_.line.text(), wait_s,
                     foreign > 0 ? ": " + foreign_bytes_text(foreign, "a Ping1D") : "");
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
