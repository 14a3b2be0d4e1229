// SPDX-License-Identifier: Apache-2.0
#include "server/offline/fan_frames.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/npy/npy_file.hpp"
#include "server/devices/device_type.hpp"
#include "server/offline/frame_times.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/vehicle_body.hpp"
#include "server/recording/glf_device.hpp"
#include "server/recording/glf_records.hpp"

namespace sonard::server {
namespace {

std::vector<std::uint8_t> high_bytes(const std::vector<std::uint16_t>& samples) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(samples.size());
  std::ranges::transform(samples, std::back_inserter(bytes),
                         [](std::uint16_t sample) { return static_cast<std::uint8_t>(sample >> 8); });
  return bytes;
}

/// Plans the pings. @return number of their frames
int count_of(Survey& survey, int pings) {
  return static_cast<int>(survey.frames(pings).size()) - 1;
}

}  // namespace

FanFrames::FanFrames(const HeadConfig& head, const HeadPlace& place, std::unique_ptr<Survey> survey,
                     const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      options_(options),
      place_(place),
      trajectory_(trajectory),
      survey_(std::move(survey)),
      times_(frame_times(trajectory, options, *survey_)),
      count_(count_of(*survey_, times_.count_until(trajectory.end_ns()))),
      job_(survey_->job(0)),
      bearings_rad_(survey_->bearings_rad()),
      truth_(truth),
      fan_({bearings_rad_, job_.bins(), survey_->client_bin_m()}, {.radius_px = options.radius_px}) {
  if (options.clean_pictures) {
    clean_fan_.emplace(fan_.geometry().shape(),
                       picture::FanStyle{.radius_px = options.radius_px, .grid = false});
  }
}

std::string FanFrames::name(int frame) const {
  return fmt::format("ping_{:06}", frame);
}

render::Pose FanFrames::T_world_sonar(std::int64_t time_ns) const {
  return trajectory_.T_world_vehicle(time_ns) * head_.T_vehicle_sonar;
}

render::PingRequest FanFrames::request(int frame) const {
  const std::int64_t time_ns = times_.at(frame);
  return {T_world_sonar(time_ns), type_of(head_).sonar_settings(job_, head_),
          static_cast<std::uint64_t>(frame), head_.seed,
          trajectory_.T_world_vehicle_at_end(time_ns, time_ns + job_.listening_time.count()) *
              head_.T_vehicle_sonar};
}

void FanFrames::pass(render::SonarRenderer& renderer, int frame) {
  const render::PingRequest ping = request(frame);
  place_bodies(trajectory_, times_.at(frame), renderer, nullptr);
  if (!renderer.pass_ping(ping, place_.head)) {
    renderer.render_ping(ping, place_.head);
  }
}

Frame FanFrames::render(render::SonarRenderer& renderer, int frame) {
  const render::PingRequest ping = request(frame);
  place_bodies(trajectory_, times_.at(frame), renderer, truth_);
  render::PingSamples rendered = renderer.render_ping(ping, place_.head);
  auto samples = std::make_shared<const npy::Table>(
      npy::Table{rendered.bins, rendered.beams, std::move(rendered.u8), std::move(rendered.u16)});
  Frame made;
  made.view = {.time_ns = times_.at(frame), .range_m = ping.settings.range.max_range_m()};
  made.view.add(renderer.last_statistics());
  made.npy = npy::encode(*samples);
  cv::Mat ids;
  if (truth_ != nullptr) {
    const npy::Table bodies = truth_->table(samples->rows, samples->columns, truth_->bodies_in(ping));
    made.bodies_npy = npy::encode(bodies);
    ids = mask_matrix(bodies);
  }
  if (options_.clean_pictures) {
    made.draw_clean = [this, samples, ids, frame] { return clean_pictures(frame, *samples, ids); };
  }
  made.sidecar = sidecar(frame, ping);
  made.draw = [this, samples, frame] { return fan_.draw(eight_bit_matrix(*samples), caption(frame)); };
  return made;
}

std::string FanFrames::caption(int frame) const {
  return fmt::format("{}   ping {}   {:.3f} s   {:.1f} m", head_.name, frame,
                     1e-9 * static_cast<double>(times_.at(frame)), fan_.geometry().range_m());
}

bool FanFrames::makes_glf() const {
  return glf_device(*head_.type) != nullptr;
}

std::optional<PingRecord> FanFrames::ping_record(int frame, std::string_view npy) const {
  Result<npy::Table, std::string> samples = npy::parse(npy);
  if (!samples || samples->rows != job_.bins() || samples->columns != std::ssize(bearings_rad_) ||
      samples->u8.empty() != job_.sixteen_bit) {
    return std::nullopt;
  }
  return survey_->record(frame, job_.sixteen_bit ? high_bytes(samples->u16) : std::move(samples->u8));
}

std::vector<PingSent> FanFrames::pings(int frame, std::string_view npy) const {
  std::optional<PingRecord> ping = ping_record(frame, npy);
  if (!ping) {
    return {};
  }
  return {sent_ping(std::move(*ping), unix_ns(frame), trajectory_.T_world_vehicle(times_.at(frame)), head_)};
}

std::vector<CleanPicture> FanFrames::clean_pictures(int frame, const npy::Table& samples,
                                                    const cv::Mat& ids) const {
  const CleanNames names(name(frame));
  const cv::Mat grey = eight_bit_matrix(samples);
  std::vector<CleanPicture> pictures{{names.grey, grey}, {names.fan, clean_fan_->project(grey)}};
  if (!ids.empty()) {
    pictures.push_back({names.grey_mask, ids});
    pictures.push_back({names.fan_mask, clean_fan_->project(ids, picture::Resampling::nearest)});
  }
  return pictures;
}

std::optional<glf::ImageRecord> FanFrames::record(int frame, std::string_view npy) const {
  std::optional<PingRecord> ping = ping_record(frame, npy);
  if (!ping) {
    return std::nullopt;
  }
  return glf_image(std::move(*ping), unix_ns(frame),
                   {0, static_cast<std::uint8_t>(place_.glf_number), type_of(head_).device_id(head_)});
}

Json FanFrames::settings_json() const {
  Json settings = survey_->settings_json();
  add_times(settings, times_, options_);
  return settings;
}

std::string FanFrames::sidecar(int frame, const render::PingRequest& request) const {
  const int beams = static_cast<int>(bearings_rad_.size());
  Json json =
      frame_json({frame, head_.name, std::string(head_.type->name()), times_.at(frame), unix_ns(frame)});
  json["device_id"] = head_.type->device_id(head_);
  json["ping_number"] = frame;
  json["head_index"] = place_.head;
  json["seed"] = head_.seed;
  if (const auto& element_seed = head_.acoustics.aperture.element_seed) {
    json["element_seed"] = *element_seed;
  }
  if (options_.draws(frame)) {
    json["picture"] = picture_name(name(frame));
  }
  json["samples"] = samples_json(name(frame), job_.sixteen_bit, {"line", job_.bins()}, {"beam", beams});
  if (clean_fan_) {
    json["clean_pictures"] = clean_json(name(frame), truth_ != nullptr, clean_fan_->geometry());
  }
  std::vector<double> to_port_rad;  // as in REP-103; devices count to starboard
  std::ranges::transform(bearings_rad_, std::back_inserter(to_port_rad), std::negate<>{});
  json["geometry"] = {{"line_step_m", job_.bin_m()},
                      {"range_m", job_.bin_m() * job_.bins()},
                      {"sound_speed_mps", job_.sound_speed_mps},
                      {"bearings_rad", to_port_rad}};
  json["settings"] = settings_json();
  json["T_world_vehicle"] = pose_json(trajectory_.T_world_vehicle(times_.at(frame)));
  json["T_world_sonar"] = pose_json(request.T_world_sonar);
  json["T_world_sonar_at_end"] = pose_json(*request.T_world_sonar_at_end);
  json["truth"] = truth_json(name(frame), truth_);
  return sidecar_text(json);
}

}  // namespace sonard::server
