// SPDX-License-Identifier: Apache-2.0
// `sonarview sonar3d15`.
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
#include "clients/sonarview/sonar3d15/image_listener.hpp"
#include "clients/sonarview/sonar3d15/options.hpp"
#include "clients/sonarview/sonar3d15/shots.hpp"
#include "common/text/printable.hpp"
#include "protocol/sonar3d15/shot.hpp"
#include "renderer/picture/direction_picture.hpp"

namespace sonard::client {
namespace {

constexpr std::chrono::milliseconds stop_patience{500};
constexpr double degree = std::numbers::pi / 180.0;

picture::DirectionImage image_of(const ReceivedShot& shot) {
  picture::DirectionImage image{
      .columns = static_cast<int>(shot.range.width()),
      .rows = static_cast<int>(shot.range.height()),
      .horizontal_fov_rad = shot.range.fov_horizontal() * degree,
      .vertical_fov_rad = shot.range.fov_vertical() * degree,
      .most_range_m = std::max(0.1, static_cast<double>(shot.range.range())),
      .range_m = {},
      .signal = {shot.signal.image_pixel_data().begin(), shot.signal.image_pixel_data().end()}};
  for (int pixel = 0; pixel < shot.range.image_pixel_data_size(); ++pixel) {
    image.range_m.push_back(static_cast<float>(sonar3d15::distance_m(shot.range, pixel)));
  }
  return image;
}

double filled_percent(const sonar3d15::RangeImage& range) {
  const auto filled = std::ranges::count_if(range.image_pixel_data(), [](auto code) { return code > 0; });
  return 100.0 * static_cast<double>(filled) / std::max(1, range.image_pixel_data_size());
}

class Viewer final : public LineViewer {
 public:
  explicit Viewer(const Sonar3d15Options& options) : LineViewer(options.run), options_(options) {}

 private:
  void begin(TimePoint at) override;
  void on_opened() override;
  void on_bytes(TimePoint at, std::span<const std::uint8_t> bytes) override;
  bool head_met() const override { return answered_; }
  void take_received() override;
  bool finished() const override {
    return stopping() ? requests_.empty() : options_.run.pings > 0 && pings() >= options_.run.pings;
  }
  std::chrono::nanoseconds say_goodbye(TimePoint at) override;
  void refresh_pictures(ImageWriter& to) override;
  void finish_pictures(ImageWriter& to) override;
  std::string progress_text(std::uint64_t fresh) const override;
  std::string awaited_text() const override {
    return fmt::format("a connection to http://{}:{}", options_.head, options_.port);
  }
  std::string no_head_text(double wait_s) const override {
    return fmt::format("{}:{} is open, but did not answer within {:.1f} s", options_.head, options_.port,
                       wait_s);
  }
  std::string no_ping_text(double wait_s) const override;
  bool sum_up(const RunCounters& counters) override;

  void send_next();
  void take_shot(const ReceivedShot& shot);
  std::vector<Picture> pictures(const std::string& name) const;

  const Sonar3d15Options options_;
  std::optional<ImageListener> images_;
  std::vector<sonar3d15::Request> requests_;  ///< not answered; the first is sent
  std::vector<std::uint8_t> reply_;           ///< its first bytes
  bool answered_ = false;
  Shots shots_;
  std::optional<ReceivedShot> newest_;
};

void Viewer::begin(TimePoint) {
  images_.emplace(io(), options_.interface, [this](const Endpoint&, std::span<const std::uint8_t> datagram) {
    shots_.receive(steady_now(), datagram);
    advance();
  });
  open_line({.way = LineAddress::Way::tcp, .place = options_.head, .port = options_.port});
}

// ---- Requests

void Viewer::on_opened() {
  requests_ = options_.settings;
  reply_.clear();
  send_next();
}

void Viewer::send_next() {
  if (!requests_.empty()) {
    send(sonar3d15::encode(requests_.front()));
  }
}

void Viewer::on_bytes(TimePoint, std::span<const std::uint8_t> bytes) {
  reply_.insert(reply_.end(), bytes.begin(), bytes.end());
  const std::optional<sonar3d15::Reply> reply = sonar3d15::decode_reply(reply_);
  if (!reply || requests_.empty()) {
    return;
  }
  answered_ = true;
  const sonar3d15::Request request = requests_.front();
  requests_.erase(requests_.begin());
  reply_.clear();
  if (reply->status >= 300 && !stopping()) {
    give_up(ExitStatus::incomplete, fmt::format("the head answered {} to {} {}: {}", reply->status,
                                                request.path, request.body, printable(reply->body)));
    return;
  }
  send_next();
}

/// Ends the images, because the head goes on without its clients.
std::chrono::nanoseconds Viewer::say_goodbye(TimePoint) {
  if (!head_met() || !line_is_open()) {
    return {};
  }
  requests_ = {set("acoustics/enabled", "false")};
  reply_.clear();
  send_next();
  return stop_patience;
}

// ---- Shots

void Viewer::take_received() {
  for (const ReceivedShot& shot : shots_.take()) {
    if (!finished()) {
      take_shot(shot);
    }
  }
}

void Viewer::take_shot(const ReceivedShot& shot) {
  count_ping(shot.received);
  newest_ = shot;
  if (options_.run.log_pings) {
    boost::crc_32_type crc;
    for (const std::uint32_t code : shot.range.image_pixel_data()) {
      crc.process_bytes(&code, sizeof code);
    }
    crc.process_bytes(shot.signal.image_pixel_data().data(), shot.signal.image_pixel_data().size());
    fmt::print(
        "ping number={} utc_s={}.{:09} columns={} rows={} range_m={:.2f} sound_speed={:.1f} filled={:.1f} "
        "crc32={:08x}\n",
        shot.range.header().sequence_id(), shot.range.header().timestamp().seconds(),
        shot.range.header().timestamp().nanos(), shot.range.width(), shot.range.height(), shot.range.range(),
        shot.range.speed_of_sound(), filled_percent(shot.range), crc.checksum());
    std::fflush(stdout);
  }
  if (ImageWriter* const to = writer();
      to != nullptr && options_.run.every > 0 && pings() % options_.run.every == 0) {
    to->write(pictures(fmt::format("{:06}", pings())));
  }
}

std::vector<Picture> Viewer::pictures(const std::string& name) const {
  const auto shot = std::make_shared<const ReceivedShot>(*newest_);
  return {{fmt::format("shot-{}.png", name), [shot, height_px = options_.run.radius_px] {
             return picture::draw(
                 image_of(*shot), height_px,
                 fmt::format("Sonar 3D-15   shot {}   {} x {}   {:.1f} m   {:.0f} % filled",
                             shot->range.header().sequence_id(), shot->range.width(), shot->range.height(),
                             shot->range.range(), filled_percent(shot->range)));
           }}};
}

void Viewer::refresh_pictures(ImageWriter& to) {
  if (newest_) {
    to.refresh(pictures("last"));
  }
}

void Viewer::finish_pictures(ImageWriter& to) {
  if (newest_) {
    to.write(pictures("last"));
  }
}

// ---- Messages

std::string Viewer::progress_text(std::uint64_t fresh) const {
  return fmt::format("{} pings, {} in the last second; {} missed", pings(), fresh,
                     shots_.statistics().shots_missed);
}

std::string Viewer::no_ping_text(double wait_s) const {
  return fmt::format(
      "no shot for {:.1f} s: check that the head has a pose, that --interface is this machine's address on "
      "the head's network, and that no firewall blocks UDP port {}",
      wait_s, sonar3d15::multicast_group.port);
}

bool Viewer::sum_up(const RunCounters& counters) {
  const ShotStatistics& seen = shots_.statistics();
  fmt::print(
      "summary pings={} rate_hz={:.2f} pings_missed={} filled={:.1f} packets={} packets_bad={} unpaired={} "
      "reconnects={} images_written={} images_skipped={}\n",
      counters.pings, counters.rate_hz, seen.shots_missed, newest_ ? filled_percent(newest_->range) : 0.0,
      seen.packets, seen.bad_packets, seen.unpaired, counters.reconnects, counters.images_written,
      counters.images_skipped);
  return counters.pings > 0 && seen.shots_missed == 0 && seen.bad_packets == 0;
}

constexpr const char* summary = "Client for a Sonar 3D-15: ranges, signals and points as pictures.";

constexpr const char* footer = R"(Examples:
  sonarview sonar3d15 --head 127.0.0.5 --port 8080 --interface 127.0.0.1 --out out   the demo, until Ctrl-C
  sonarview sonar3d15 --head 192.168.2.96 --frequency high --range 4 --pings 100 --log-pings

Exit status: 0 shots arrived, and none was missed; 1 a socket or a file could not be opened or written;
2 invalid command line; 3 no head; 4 shots were missed, none arrived, or the head refuses.)";

Prepare declare(CLI::App& app) {
  const auto arguments = std::make_shared<Sonar3d15Arguments>(app);
  return [arguments] { return [options = arguments->options()] { return Viewer(options).run(); }; };
}

}  // namespace

const Subcommand& sonar3d15_subcommand() {
  static constexpr Subcommand subcommand{"sonar3d15", summary, footer, &declare};
  return subcommand;
}

}  // namespace sonard::client
