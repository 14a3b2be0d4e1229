// SPDX-License-Identifier: Apache-2.0
// `sonarview oculus`.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/crc.hpp>
#include <cstdio>
#include <memory>
#include <numbers>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>

#include "clients/sonarview/common/fan_pictures.hpp"
#include "clients/sonarview/common/line_viewer.hpp"
#include "clients/sonarview/common/subcommand.hpp"
#include "clients/sonarview/oculus/options.hpp"
#include "clients/sonarview/oculus/status_listener.hpp"
#include "protocol/oculus/client.hpp"
#include "protocol/oculus/codec.hpp"
#include "protocol/oculus/image_form.hpp"

namespace sonard::client {
namespace {

constexpr std::size_t longest_log = 200;  // bytes of a text from the head that are shown

std::string address_of(const oculus::Status& status) {
  return fmt::format("{}", fmt::join(status.address, "."));
}

FanPing picture_of(const oculus::PingResult& ping) {
  picture::FanShape shape;
  for (const std::int16_t bearing : ping.bearings_cdeg) {
    shape.bearings_rad.push_back(bearing * std::numbers::pi / 18000.0);
  }
  shape.lines = ping.ranges;
  shape.line_step_m = ping.range_resolution_m;
  std::vector<std::uint8_t> samples = oculus::eight_bit_samples(ping);
  return {.shape = shape,
          .samples = cv::Mat(ping.ranges, ping.beams, CV_8UC1, samples.data()).clone(),
          .amplitude_exponent = oculus::gamma_exponent(ping.fire.fire.gamma),
          .caption = fmt::format("Oculus  {:.0f} kHz   ping {}   {} beams   {:.1f} m",
                                 ping.frequency_hz * 1e-3, ping.ping_id, ping.beams, shape.range_m())};
}

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const OculusOptions& options)
      : LineViewer(options.run), options_(options), pictures_(options.run) {}

 private:
  void begin(TimePoint at) override;
  void on_opened() override;
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override { client_.receive(at, bytes); }
  bool head_met() const override { return connected_; }
  void take_received() override;
  bool finished() const override { return options_.run.pings > 0 && pings() >= options_.run.pings; }
  void refresh_pictures(ImageWriter& to) override { pictures_.refresh(to); }
  void finish_pictures(ImageWriter& to) override { pictures_.finish(to); }
  std::string progress_text(std::uint64_t fresh) const override;
  std::string awaited_text() const override;
  std::string no_head_text(double wait_s) const override;
  std::string not_open_advice() const override;
  std::string no_ping_text(double wait_s) const override;
  bool sum_up(const RunCounters& counters) override;

  void meet(const oculus::Status& status);
  void connect_to(const std::string& address);
  void take_ping(const oculus::ReceivedPing& ping);

  const OculusOptions options_;
  std::optional<StatusListener> statuses_;  ///< until the connection is open
  std::set<std::string> addresses_;         ///< of the heads that sent a status
  bool connected_ = false;                  ///< whether the connection was ever open
  oculus::Client client_;
  FanPictures pictures_;
};

void Viewer::begin(TimePoint) {
  const Endpoint bind{options_.bind_address, options_.status_port};
  if (options_.head.empty()) {
    statuses_.emplace(io(), bind, [this](const oculus::Status& status) { meet(status); });
    return;
  }
  try {
    statuses_.emplace(io(), bind,
                      [this](const oculus::Status& status) { addresses_.insert(address_of(status)); });
  } catch (const std::runtime_error&) {
    // Statuses would only help to explain why no head answers at --head.
  }
  connect_to(options_.head);
}

void Viewer::meet(const oculus::Status& status) {
  const auto& client = status.client;
  say(fmt::format("head {}, part {}, at {}{}", status.device_id, status.part_number, address_of(status),
                  client == decltype(status.client){} ? "" : ", which already has a client"));
  statuses_->close();
  connect_to(address_of(status));
}

void Viewer::connect_to(const std::string& address) {
  open_line({.way = LineAddress::Way::tcp, .place = address, .port = options_.port});
}

void Viewer::on_opened() {
  connected_ = true;
  if (statuses_) {
    statuses_->close();
  }
  client_.connected();
  send(oculus::encode(options_.fire));
}

void Viewer::take_received() {
  for (const std::string& text : client_.take_logs()) {
    say("log of the head: " + text.substr(0, longest_log));
  }
  for (const oculus::ReceivedPing& ping : client_.take_pings()) {
    if (!finished()) {
      take_ping(ping);
    }
  }
}

void Viewer::take_ping(const oculus::ReceivedPing& ping) {
  count_ping(ping.received);
  const oculus::PingResult& result = ping.result;
  if (options_.run.log_pings) {
    boost::crc_32_type crc;
    crc.process_bytes(result.image.data(), result.image.size());
    fmt::print(
        "ping id={} mode={} frequency_hz={:.0f} ranges={} beams={} resolution_m={:.6f} bits={} gain={:.1f} "
        "sound_speed={:.2f} heading_deg={:.2f} pitch_deg={:.2f} roll_deg={:.2f} pressure_bar={:.3f} "
        "temperature_c={:.1f} start_s={:.6f} bytes={} crc32={:08x}\n",
        result.ping_id, result.fire.fire.master_mode, result.frequency_hz, result.ranges, result.beams,
        result.range_resolution_m, 8 * (static_cast<int>(result.data_size) + 1),
        result.fire.fire.gain_percent, result.sound_speed_mps, result.heading_deg, result.pitch_deg,
        result.roll_deg, result.pressure_bar, result.temperature_c, result.start_time_s, ping.message.size(),
        crc.checksum());
    std::fflush(stdout);
  }
  if (ImageWriter* const to = writer()) {
    pictures_.take(*to, picture_of(result), pings());
  }
}

// ---- Messages

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; {} missed", pings(), fresh,
                     client_.statistics().pings_missed);
}

std::string Viewer::awaited_text() const {
  return options_.head.empty()
             ? fmt::format("the status packet of a head on UDP port {}", options_.status_port)
             : fmt::format("a connection to tcp {}:{}", options_.head, options_.port);
}

std::string Viewer::no_head_text(double wait_s) const {
  return fmt::format(
      "no status on port {} within {:.1f} s: check that sonard runs, that it sends its status to this "
      "address or broadcasts it on this network, and that no firewall blocks UDP",
      options_.status_port, wait_s);
}

std::string Viewer::not_open_advice() const {
  return addresses_.empty() ? ""
                            : fmt::format("; a status came from {} (to view one, use --head {})",
                                          fmt::join(addresses_, ", "), *addresses_.begin());
}

std::string Viewer::no_ping_text(double wait_s) const {
  const oculus::ClientStatistics& client = client_.statistics();
  return fmt::format("no ping for {:.1f} s: {}", wait_s,
                     client.messages == 0 && client.dropped_bytes > 0
                         ? foreign_bytes_text(client.dropped_bytes, "an Oculus")
                         : "check that the head has a pose");
}

bool Viewer::sum_up(const RunCounters& counters) {
  const oculus::ClientStatistics& client = client_.statistics();
  fmt::print(
      "summary pings={} rate_hz={:.2f} pings_missed={} reconnects={} messages={} messages_bad={} "
      "bytes_dropped={} images_written={} images_skipped={}\n",
      counters.pings, counters.rate_hz, client.pings_missed, counters.reconnects, client.messages,
      client.bad_messages, client.dropped_bytes, counters.images_written, counters.images_skipped);
  return counters.pings > 0 && client.pings_missed == 0 && client.bad_messages == 0;
}

constexpr const char* summary = "Client for an Oculus: pings, reports the rate, writes pictures.";

constexpr const char* footer = R"(Examples:
  sonarview oculus --out out                              the head whose status packet arrives first, until Ctrl-C
  sonarview oculus --head 127.0.0.3 --pings 10 --bits 16  ten pings of 512 beams
  sonarview oculus --frequency high --range 5 --rate 40   the narrow fan, as fast as the head can

Exit status: 0 pings arrived, and no ping was missed; 1 a socket or a file could not be opened or written;
2 invalid command line; 3 no head; 4 pings were missed, or no ping arrived.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<OculusArguments>(app);
  return [arguments] { return [options = arguments->options()] { return Viewer(options).run(); }; };
}

}  // namespace

const Subcommand& oculus_subcommand() {
  static constexpr Subcommand subcommand{"oculus", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
