// SPDX-License-Identifier: Apache-2.0
// `sonarview dvl_a50`: prints velocities, altitude and dead reckoning as text.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "clients/sonarview/common/line_viewer.hpp"
#include "clients/sonarview/common/link_arguments.hpp"
#include "clients/sonarview/common/run_options.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "protocol/dvl_a50/client.hpp"

namespace sonard::client {
namespace {

struct Options {
  LineAddress line;
  RunOptions run;
  bool reset = false;
};

std::string velocity_text(const dvl_a50::Velocity& report) {
  const dvl_a50::Vector& v = report.velocity_mps;
  return fmt::format("velocity {:.3f} {:.3f} {:.3f} m/s, altitude {:.2f} m, fom {:.4f}, {}", v[0], v[1], v[2],
                     report.altitude_m, report.fom_mps, report.valid ? "valid" : "no lock");
}

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const Options& options) : LineViewer(options.run), options_(options) {}

 private:
  void begin(TimePoint) override { open_line(options_.line); }
  void on_opened() override {
    client_ = {};
    reset_ = options_.reset;
  }
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override {
    received_ = at;
    client_.on_bytes(bytes);
  }
  void talk(TimePoint) override {
    if (std::exchange(reset_, false)) {
      const std::string text = dvl_a50::command_text("reset_dead_reckoning");
      send(std::vector<std::uint8_t>(text.begin(), text.end()));
    }
  }
  bool head_met() const override { return reports_ > 0; }
  void take_received() override;
  bool finished() const override { return options_.run.pings > 0 && pings() >= options_.run.pings; }
  void refresh_pictures(ImageWriter&) override {}
  void finish_pictures(ImageWriter&) override {}
  std::string progress_text(std::uint64_t fresh) const override {
    return fmt::format("{} reports, {} in the last second; {}", pings(), fresh, velocity_text(newest_));
  }
  std::string awaited_text() const override { return fmt::format("a DVL on {}", options_.line.text()); }
  std::string no_head_text(double wait_s) const override {
    const std::uint64_t foreign = client_.dropped_bytes();
    return fmt::format("{} is open, but no report came within {:.1f} s{}", options_.line.text(), wait_s,
                       foreign > 0 ? ": " + foreign_bytes_text(foreign, "a DVL") : "");
  }
  std::string no_ping_text(double wait_s) const override {
    return fmt::format("no velocity report for {:.1f} s", wait_s);
  }
  bool sum_up(const RunCounters& counters) override;
  void log(const dvl_a50::Velocity& report) const;

  const Options options_;
  dvl_a50::Client client_;
  dvl_a50::Velocity newest_;
  dvl_a50::Position position_;
  TimePoint received_{};
  std::uint64_t reports_ = 0, valid_ = 0;
  bool reset_ = false;
};

void Viewer::take_received() {
  for (const dvl_a50::Report& report : client_.take()) {
    ++reports_;
    if (const auto* const position = std::get_if<dvl_a50::Position>(&report)) {
      position_ = *position;
    } else if (const auto* const velocity = std::get_if<dvl_a50::Velocity>(&report);
               velocity && !stopping()) {
      count_ping(received_);
      newest_ = *velocity;
      valid_ += velocity->valid ? 1 : 0;
      log(*velocity);
    }
  }
}

void Viewer::log(const dvl_a50::Velocity& report) const {
  if (!options_.run.log_pings) {
    return;
  }
  const auto& beams = report.beams;
  fmt::print(
      "ping vx={:.4f} vy={:.4f} vz={:.4f} altitude_m={:.3f} valid={} distances_m={:.3f},{:.3f},{:.3f},{:.3f} "
      "time_ms={:.1f}\n",
      report.velocity_mps[0], report.velocity_mps[1], report.velocity_mps[2], report.altitude_m,
      report.valid ? 1 : 0, beams[0].distance_m, beams[1].distance_m, beams[2].distance_m,
      beams[3].distance_m, report.since_last_ms);
  std::fflush(stdout);
}

bool Viewer::sum_up(const RunCounters& counters) {
  const dvl_a50::Vector& p = position_.position_m;
  fmt::print(
      "summary pings={} valid={} rate_hz={:.2f} altitude_m={:.3f} x_m={:.2f} y_m={:.2f} z_m={:.2f} "
      "yaw_deg={:.1f} "
      "reconnects={} unreadable={}\n",
      counters.pings, valid_, counters.rate_hz, newest_.altitude_m, p[0], p[1], p[2], position_.yaw_deg,
      counters.reconnects, client_.unreadable());
  return counters.pings > 0;
}

constexpr const char* summary =
    "Client for a DVL A50 or A125: shows velocities, altitude and dead reckoning.";

constexpr const char* footer = R"(Examples:
  sonarview dvl_a50 --tcp 127.0.0.1:16171
  sonarview dvl_a50 --tcp 127.0.0.1:16171 --reset --pings 100 --log-pings

Exit status: 0 reports arrived; 2 invalid command line; 3 no device; 4 no velocity report arrived.)";

/// As typed.
struct Arguments {
  LinkArguments link;
  RunArguments run{500, 10.0};
  bool reset = false;
};

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<Arguments>();
  arguments->link.declare(app);
  app.add_flag("--reset", arguments->reset, "Reset dead reckoning first")->group("Sonar");
  arguments->run.declare(app, {.link_group = LinkArguments::group});
  return [arguments] {
    const Options options{arguments->link.address(), arguments->run.options(), arguments->reset};
    return [options] { return Viewer(options).run(); };
  };
}

}  // namespace

const Subcommand& dvl_a50_subcommand() {
  static constexpr Subcommand subcommand{"dvl_a50", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
