// SPDX-License-Identifier: Apache-2.0
#include "server/offline/sweep_frames.hpp"

#include <cstdint>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/npy/npy_file.hpp"
#include "server/devices/device_type.hpp"
#include "server/offline/frame_times.hpp"
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

/// Number of bins of the pings of a survey.
int bins_of(const Survey& survey, const std::vector<int>& first_lines) {
  return first_lines.size() > 1 ? survey.job(0).bins() : 1;
}

}  // namespace

SweepFrames::SweepFrames(const HeadConfig& head, int head_index, std::unique_ptr<Survey> survey,
                         const VehicleTrajectory& trajectory, const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      options_(options),
      head_index_(head_index),
      trajectory_(trajectory),
      survey_(std::move(survey)),
      times_(frame_times(trajectory, options, *survey_)),
      first_lines_(survey_->frames(times_.count_until(trajectory.end_ns()))),
      bins_(bins_of(*survey_, first_lines_)),
      truth_(truth),
      picture_(shape_of(*survey_, bins_), {.radius_px = options.radius_px}) {
  if (options.clean_pictures) {
    clean_picture_.emplace(shape_of(*survey_, bins_),
                           picture::FanStyle{.radius_px = options.radius_px, .grid = false});
  }
}

std::string SweepFrames::name(int frame) const {
  return fmt::format("scan_{:06}", frame);
}

render::PingRequest SweepFrames::request(int line) const {
  const PingJob ping = survey_->job(line);
  const std::int64_t time_ns = times_.at(line);
  const auto transducer_at = [&](const render::Pose& T_world_vehicle) {
    return T_world_transducer(T_world_vehicle * head_.T_vehicle_sonar, ping.bearing_rad);
  };
  return {transducer_at(trajectory_.T_world_vehicle(time_ns)), type_of(head_).sonar_settings(ping, head_),
          static_cast<std::uint64_t>(line), head_.seed,
          transducer_at(trajectory_.T_world_vehicle_at_end(time_ns, time_ns + ping.listening_time.count()))};
}

void SweepFrames::pass(render::SonarRenderer& renderer, int frame) {
  for (int line = first_line(frame); line < first_line(frame + 1); ++line) {
    const render::PingRequest ping = request(line);
    place_bodies(trajectory_, times_.at(line), renderer, nullptr);
    if (!renderer.pass_ping(ping, head_index_)) {
      renderer.render_ping(ping, head_index_);
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
  FrameView view{.time_ns = times_.at(first), .range_m = 0.0};
  for (int column = 0; column < columns; ++column) {
    const render::PingRequest ping = request(first + column);
    place_bodies(trajectory_, times_.at(first + column), renderer, truth_);
    picture::SweepLine line{picture::turn_bearing(survey_->job(first + column).bearing_rad),
                            renderer.render_ping(ping, head_index_).u8};
    view.range_m = ping.settings.range.max_range_m();
    view.add(renderer.last_statistics());
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
  made.view = view;
  made.npy = npy::encode(samples);
  std::shared_ptr<const npy::Table> ids;
  if (truth_ != nullptr) {
    ids = std::make_shared<const npy::Table>(truth_->table(samples.rows, samples.columns, bodies));
    made.bodies_npy = npy::encode(*ids);
  }
  if (options_.clean_pictures) {
    made.draw_clean = [this, kept = std::make_shared<const npy::Table>(std::move(samples)), ids, frame] {
      return clean_pictures(frame, *kept, ids.get());
    };
  }
  made.sidecar = sidecar(frame);
  made.draw = [this, lines, frame] {
    return picture_.draw(*lines, fmt::format("{}   scan {}   {} lines   {:.1f} m", head_.name, frame,
                                             lines->size(), bins_ * survey_->client_bin_m()));
  };
  return made;
}

std::vector<CleanPicture> SweepFrames::clean_pictures(int frame, const npy::Table& samples,
                                                      const npy::Table* bodies) const {
  const CleanNames names(name(frame));
  const auto lines_of = [&](const cv::Mat& columns) {
    std::vector<picture::SweepLine> lines;
    for (int column = 0; column < columns.cols; ++column) {
      const cv::Mat line = columns.col(column).clone();
      lines.push_back({picture::turn_bearing(survey_->job(first_line(frame) + column).bearing_rad),
                       std::vector<std::uint8_t>(line.begin<std::uint8_t>(), line.end<std::uint8_t>())});
    }
    return lines;
  };
  const cv::Mat grey = eight_bit_matrix(samples);
  std::vector<CleanPicture> pictures{{names.grey, grey},
                                     {names.fan, clean_picture_->project(lines_of(grey)).samples}};
  if (bodies != nullptr) {
    const cv::Mat ids = mask_matrix(*bodies);
    pictures.push_back({names.grey_mask, ids});
    pictures.push_back(
        {names.fan_mask, clean_picture_->project(lines_of(ids), picture::Resampling::nearest).samples});
  }
  return pictures;
}

std::vector<PingSent> SweepFrames::pings(int frame, std::string_view npy) const {
  const int first = first_line(frame);
  const int columns = first_line(frame + 1) - first;
  const Result<npy::Table, std::string> samples = npy::parse(npy);
  if (!samples || samples->rows != bins_ || samples->columns != columns || samples->u8.empty()) {
    return {};
  }
  std::vector<PingSent> sent;
  for (int column = 0; column < columns; ++column) {
    std::vector<std::uint8_t> line;
    for (std::size_t at = static_cast<std::size_t>(column); at < samples->u8.size();
         at += static_cast<std::size_t>(columns)) {
      line.push_back(samples->u8[at]);
    }
    const std::int64_t time_ns = times_.at(first + column);
    sent.push_back(sent_ping(survey_->record(first + column, std::move(line)), trajectory_.unix_ns(time_ns),
                             trajectory_.T_world_vehicle(time_ns), head_));
  }
  return sent;
}

Json SweepFrames::settings_json() const {
  Json settings = survey_->settings_json();
  add_times(settings, times_, options_);
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
      frame_json({frame, head_.name, std::string(head_.type->name()), times_.at(first), unix_ns(frame)});
  json["device_id"] = head_.type->device_id(head_);
  json["first_ping_number"] = first;
  json["head_index"] = head_index_;
  json["seed"] = head_.seed;
  if (const auto& element_seed = head_.acoustics.aperture.element_seed) {
    json["element_seed"] = *element_seed;
  }
  if (options_.draws(frame)) {
    json["picture"] = picture_name(name(frame));
  }
  json["samples"] = samples_json(name(frame), false, {"bin", bins_}, {"line", end - first});
  if (clean_picture_) {
    json["clean_pictures"] = clean_json(name(frame), truth_ != nullptr, clean_picture_->geometry());
  }
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
