// SPDX-License-Identifier: Apache-2.0
#include "server/offline/sweep_frames.hpp"

#include <cstdint>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/npy/npy_file.hpp"
#include "server/devices/device_kind.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/vehicle_body.hpp"

namespace sonard::server {
namespace {

picture::SweepShape shape_of(const Survey& survey, int bins) {
  const Survey::Sector sector = survey.sector();
  picture::SweepShape shape;
  shape.width = picture::turn_units(sector.width_rad);
  shape.left = shape.width == picture::units_per_turn ? 0 : picture::turn_bearing(sector.left_rad);
  shape.step = picture::turn_units(sector.step_rad);
  shape.bins = bins;
  shape.bin_m = survey.client_bin_m();
  return shape;
}

/// Bins of all pings of a survey.
int bins_of(const Survey& survey, const std::vector<int>& first_lines) {
  return first_lines.size() > 1 ? survey.job(0).bins() : 1;
}

}  // namespace

SweepFrames::SweepFrames(const HeadConfig& head, int stream, std::unique_ptr<Survey> survey,
                         const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      options_(options),
      stream_(stream),
      trajectory_(trajectory),
      survey_(std::move(survey)),
      times_{trajectory.start_ns(), options.rate_hz ? 1e9 / *options.rate_hz
                                                    : static_cast<double>(survey_->natural_period().count())},
      first_lines_(survey_->frames(times_.count_until(trajectory.end_ns()))),
      bins_(bins_of(*survey_, first_lines_)),
      truth_(truth),
      picture_(shape_of(*survey_, bins_), {.radius_px = options.radius_px}) {}

std::string SweepFrames::name(int frame) const {
  return fmt::format("scan_{:06}", frame);
}

render::PingRequest SweepFrames::request(int line) const {
  const PingJob ping = survey_->job(line);
  const std::int64_t time_ns = times_.at(line);
  const auto pose_at = [&](std::int64_t time) {
    return T_world_transducer(trajectory_.T_world_vehicle(time) * head_.T_vehicle_sonar, ping.bearing_rad);
  };
  return {pose_at(time_ns), kind_of(head_).sonar_settings(ping, head_), static_cast<std::uint64_t>(line),
          head_.seed, pose_at(time_ns + ping.listening_time.count())};
}

void SweepFrames::pass(render::SonarRenderer& renderer, int frame) {
  for (int line = first_line(frame); line < first_line(frame + 1); ++line) {
    const render::PingRequest ping = request(line);
    place_bodies(trajectory_, times_.at(line), renderer, nullptr);
    if (!renderer.pass_ping(ping, stream_)) {
      renderer.render_ping(ping, stream_);
    }
  }
}

Frame SweepFrames::render(render::SonarRenderer& renderer, int frame) {
  const int first = first_line(frame);
  const int columns = first_line(frame + 1) - first;
  const auto bins = static_cast<std::size_t>(bins_);
  const auto at = [columns](std::size_t bin, int column) {
    return bin * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  };
  npy::Table samples{bins_, columns, std::vector<std::uint8_t>(at(bins, 0)), {}};
  std::vector<std::uint16_t> bodies(truth_ != nullptr ? samples.u8.size() : 0);
  auto lines = std::make_shared<std::vector<picture::SweepLine>>();
  for (int column = 0; column < columns; ++column) {
    const render::PingRequest ping = request(first + column);
    place_bodies(trajectory_, times_.at(first + column), renderer, truth_);
    picture::SweepLine line{picture::turn_bearing(survey_->job(first + column).bearing_rad),
                            renderer.render_ping(ping, stream_).u8};
    const std::vector<std::uint16_t> nearby =
        truth_ != nullptr ? truth_->bodies_in(ping) : std::vector<std::uint16_t>{};
    for (std::size_t bin = 0; bin < bins; ++bin) {
      samples.u8[at(bin, column)] = line.samples[bin];
      if (truth_ != nullptr) {
        bodies[at(bin, column)] = nearby[bin];
      }
    }
    lines->push_back(std::move(line));
  }
  Frame made;
  made.npy = npy::encode(samples);
  if (truth_ != nullptr) {
    made.bodies_npy = npy::encode(truth_->table(samples.rows, samples.columns, bodies));
  }
  made.sidecar = sidecar(frame);
  made.draw = [this, lines, frame] {
    return picture_.draw(*lines, fmt::format("{}   scan {}   {} lines   {:.1f} m", head_.name, frame,
                                             lines->size(), bins_ * survey_->client_bin_m()));
  };
  return made;
}

Json SweepFrames::settings_json() const {
  Json settings = survey_->settings_json();
  settings["period_s"] = times_.period_ns / 1e9;
  return settings;
}

std::string SweepFrames::sidecar(int frame) const {
  const int first = first_line(frame);
  const int end = first_line(frame + 1);
  const PingJob ping = survey_->job(first);
  std::vector<double> bearings_rad, stamps_s;
  Json vehicle = Json::array();
  Json transducer = Json::array();
  for (int line = first; line < end; ++line) {
    bearings_rad.push_back(-survey_->job(line).bearing_rad);  // to port, as in REP-103
    stamps_s.push_back(static_cast<double>(times_.at(line)) / 1e9);
    vehicle.push_back(pose_json(trajectory_.T_world_vehicle(times_.at(line))));
    transducer.push_back(pose_json(request(line).T_world_sonar));
  }
  Json json =
      frame_json({frame, head_.name, std::string(head_.kind->type()), times_.at(first), unix_ns(frame)});
  json["device_id"] = head_.kind->device_id(head_);
  json["first_ping_number"] = first;
  json["stream"] = stream_;
  json["seed"] = head_.seed;
  if (options_.draws(frame)) {
    json["picture"] = picture_name(name(frame));
  }
  json["samples"] = samples_json(name(frame), false, {"bin", bins_}, {"line", end - first});
  json["geometry"] = {{"line_step_m", ping.bin_m()},
                      {"range_m", ping.range_m()},
                      {"sound_speed_mps", ping.sound_speed_mps},
                      {"bearings_rad", bearings_rad}};
  json["settings"] = settings_json();
  json["stamps_s"] = stamps_s;
  json["T_world_vehicle"] = vehicle;
  json["T_world_sonar"] = transducer;
  json["truth"] = truth_json(name(frame), truth_);
  return sidecar_text(json);
}

}  // namespace sonard::server
