// SPDX-License-Identifier: Apache-2.0
// `sonarview micron`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "clients/sonarview/common/line_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/micron/line_file.hpp"
#include "clients/sonarview/micron/options.hpp"
#include "clients/sonarview/micron/scan_log.hpp"
#include "clients/sonarview/micron/scan_sweeps.hpp"
#include "protocol/micron/units.hpp"

namespace sonard::client {
namespace {

SweepForm form_of(const MicronOptions& options) {
  const micron::ScanSettings& scan = options.scan;
  picture::SweepShape shape;
  if (scan.sector) {
    shape.left = scan.sector->left;
    shape.width = micron::wrapped(scan.sector->right - scan.sector->left);
  }
  shape.step = scan.step;
  shape.bins = scan.bins;
  shape.bin_m = micron::bin_length_m(scan);
  return {.title = "Micron",
          .lines = "lines",
          .shape = shape,
          .sector = scan.sector.has_value(),
          .scale = scan.eight_bit ? 1 : 17,
          .radius_px = options.run.radius_px};
}

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const MicronOptions& options);

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

  void take_line(const micron::ReceivedLine& line);
  void greet_head();
  std::string head_text() const;

  const MicronOptions options_;
  micron::Client client_;
  ScanSweeps sweeps_;
  SweepPictures pictures_;
  std::uint64_t sweeps_done_ = 0;
  std::uint64_t parameters_sent_ = 0;
  int last_bearing_ = 0;
  std::optional<LineFile> file_;
};

Viewer::Viewer(const MicronOptions& options)
    : LineViewer(options.run),
      options_(options),
      client_(options.client, started()),
      sweeps_(micron::make_head_command(options.scan)),
      pictures_(form_of(options), options.run.every) {
  if (!options_.raw.empty()) {
    file_.emplace(options_.raw);
  }
}

void Viewer::begin(TimePoint at) {
  fmt::print("{}\n", scan_text(options_.scan));
  std::fflush(stdout);
  client_.start(at, micron::make_head_command(options_.scan), options_.run.pings);
  open_line(options_.line);
}

void Viewer::talk(TimePoint at) {
  client_.advance(at);
  for (const auto& frame : client_.take_outgoing()) {
    send(frame);
  }
}

void Viewer::take_received() {
  for (const micron::ReceivedLine& line : client_.take_lines()) {
    if (!stopping()) {
      take_line(line);
    }
  }
  if (std::exchange(parameters_sent_, client_.statistics().head_commands) != parameters_sent_) {
    sweeps_.restart();
    greet_head();
  }
}

void Viewer::take_line(const micron::ReceivedLine& line) {
  count_ping(line.received);
  last_bearing_ = line.head.bearing;
  const std::uint64_t sweep = sweeps_.current().number;
  if (options_.run.log_pings) {
    fmt::print("{}\n", line_text(line, sweep, micron::bin_length_m(options_.scan)));
    std::fflush(stdout);
  }
  if (file_) {
    file_->write(line, sweep);
  }
  const auto done = sweeps_.add(line);
  if (!done) {
    return;
  }
  ++sweeps_done_;
  if (ImageWriter* const to = writer()) {
    pictures_.write(*to, *done);
  }
  if (options_.sweeps > 0 && sweeps_done_ >= options_.sweeps) {
    stop();
  }
}

std::chrono::nanoseconds Viewer::say_goodbye(TimePoint) {
  client_.stop();
  return {};
}

// ---- Messages

void Viewer::greet_head() {
  const auto& head = client_.head();
  if (client_.statistics().head_commands != 1) {
    return;
  }
  std::string text = fmt::format("head {} at {}", options_.client.node, options_.line.text());
  if (head.version) {
    text += fmt::format(", serial number {}, software {:#04x}", head.version->serial_number,
                        head.version->software_version);
  }
  if (head.user_blocks) {
    text += fmt::format(", {} duplex", head.user_blocks->half_duplex() ? "half" : "full");
  }
  say(text);
  say(fmt::format("{} bins of {:.1f} mm: the head covers {:.3f} m of {:g} m", options_.scan.bins,
                  1e3 * micron::bin_length_m(options_.scan), micron::covered_range_m(options_.scan),
                  options_.scan.range_m));
}

std::string Viewer::head_text() const {
  const auto& alive = client_.head().alive;
  if (!line_is_open()) {
    return "the line is lost";
  }
  if (!alive) {
    return "the head has not sent its state";
  }
  const double bearing = micron::bearing_deg(alive->position);
  if (!alive->has(micron::head_info_bits::centred)) {
    return fmt::format("the head is centring, at {:+.1f} deg", bearing);
  }
  return fmt::format("the head {} parameters, at {:+.1f} deg",
                     alive->has(micron::head_info_bits::no_parameters) ? "waits for" : "has", bearing);
}

std::string Viewer::progress_text(std::uint64_t fresh) const {
  const std::uint64_t lines = client_.statistics().lines;
  if (fresh == 0) {
    return fmt::format("{} lines, 0 in the last second; {}", lines, head_text());
  }
  const std::string done =
      sweeps_.begun() ? fmt::format("turn {}, {:.0f} %", sweeps_.current().number, 100.0 * sweeps_.share())
                      : "turning to the first limit";
  return fmt::format("bearing {:+.1f} deg, {} lines, {} in the last second; {}",
                     micron::bearing_deg(last_bearing_), lines, fresh, done);
}

std::string Viewer::awaited_text() const {
  return fmt::format("head {} on {}", options_.client.node, options_.line.text());
}

std::string Viewer::no_head_text(double wait_s) const {
  const auto& others = client_.other_heads();
  const std::uint64_t foreign = client_.statistics().dropped_bytes;
  const std::string advice = others.empty() && foreign > 0 ? foreign_bytes_text(foreign, "a Micron")
                             : others.empty()
                                 ? "check its power, line, baud rate and node"
                                 : fmt::format("only node {} sent frames (to view one, use --node {})",
                                               fmt::join(others, ", node "), *others.begin());
  return fmt::format("{} is open, but head {} sent nothing within {:.1f} s: {}", options_.line.text(),
                     options_.client.node, wait_s, advice);
}

std::string Viewer::no_ping_text(double wait_s) const {
  return fmt::format("no line for {:.1f} s: {}", wait_s, head_text());
}

bool Viewer::sum_up(const RunCounters& counters) {
  if (file_ && file_->failed()) {
    fail(ExitStatus::system, "cannot write " + file_->path().string());
  }
  const micron::ClientStatistics& statistics = client_.statistics();
  fmt::print("{}\n", summary_text(statistics, sweeps_done_, sweeps_.lines_missed(), counters));
  return statistics.lines > 0 && sweeps_.lines_missed() == 0;
}

constexpr const char* summary =
    "Client for a Micron: scans, reports rate and loss, writes pictures and lines.";

constexpr const char* footer = R"(Examples:
  sonarview micron --tcp 127.0.0.1:4001 --range 20 --out out       all round, until Ctrl-C
  sonarview micron --tty /dev/ttyUSB0 --turns 1 --raw sweep.jsonl   one sweep, with its lines in a file
  sonarview micron --tcp 10.0.0.7:4001 --sector -45 45 --step 0.9  back and forth over 90 degrees ahead

Exit status: 0 all lines arrived; 1 a file could not be written; 2 invalid command line; 3 no head;
4 lines are missing, or no line arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<MicronArguments>(app);
  return [arguments] { return [options = arguments->options()] { return Viewer(options).run(); }; };
}

}  // namespace

const Subcommand& micron_subcommand() {
  static constexpr Subcommand subcommand{"micron", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
