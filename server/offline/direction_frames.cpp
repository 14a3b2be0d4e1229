// SPDX-License-Identifier: Apache-2.0
#include "server/offline/direction_frames.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "protocol/npy/npy_file.hpp"
#include "server/devices/device_type.hpp"
#include "server/devices/directions.hpp"
#include "server/offline/frame_times.hpp"
#include "server/offline/sidecar.hpp"
#include "server/offline/vehicle_body.hpp"

namespace sonard::server {
namespace {

npy::Table table_of(const DirectionRanges& sent) {
  npy::Table table{2 * sent.rows, sent.columns, {}, {}, sent.range_m};
  table.f32.insert(table.f32.end(), sent.intensity.begin(), sent.intensity.end());
  return table;
}

/// x, y, z and signal of each echo.
npy::Table points_of(const picture::DirectionImage& image) {
  npy::Table points{0, 4, {}, {}, {}};
  for (std::size_t pixel = 0; pixel < image.range_m.size(); ++pixel) {
    if (image.range_m[pixel] > 0.0F) {
      const cv::Point3f point = picture::point_of(image, pixel);
      points.f32.insert(points.f32.end(),
                        {point.x, point.y, point.z, static_cast<float>(image.signal[pixel])});
      ++points.rows;
    }
  }
  return points;
}

std::string ply_of(const npy::Table& points) {
  std::string file = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nproperty float intensity\nend_header\n",
      points.rows);
  file.append(reinterpret_cast<const char*>(points.f32.data()), points.f32.size() * sizeof(float));
  return file;
}

}  // namespace

DirectionFrames::DirectionFrames(const HeadConfig& head, const HeadPlace& place,
                                 std::unique_ptr<Survey> survey, const VehicleTrajectory& trajectory,
                                 const OfflineOptions& options, BodyTruth* truth)
    : head_(head),
      options_(options),
      place_(place),
      trajectory_(trajectory),
      survey_(std::move(survey)),
      truth_(truth),
      times_(frame_times(trajectory, options, *survey_)),
      count_(static_cast<int>(survey_->frames(times_.count_until(trajectory.end_ns())).size()) - 1),
      job_(survey_->job(0)) {}

std::string DirectionFrames::name(int frame) const {
  return fmt::format("ping_{:06}", frame);
}

render::PingRequest DirectionFrames::request(int frame) const {
  return {trajectory_.T_world_vehicle(times_.at(frame)) * head_.T_vehicle_sonar,
          type_of(head_).sonar_settings(job_, head_), static_cast<std::uint64_t>(frame), head_.seed,
          std::nullopt};
}

picture::DirectionImage DirectionFrames::image_of(const DirectionRanges& sent) const {
  picture::DirectionImage image{.columns = sent.columns,
                                .rows = sent.rows,
                                .horizontal_fov_rad = job_.directions.horizontal_fov_rad,
                                .vertical_fov_rad = job_.directions.vertical_fov_rad,
                                .most_range_m = job_.range_m(),
                                .range_m = sent.range_m,
                                .signal = {}};
  std::ranges::transform(sent.intensity, std::back_inserter(image.signal),
                         [](float signal) { return static_cast<std::uint8_t>(signal); });
  return image;
}

Frame DirectionFrames::render(render::SonarRenderer& renderer, int frame) {
  const render::PingRequest ping = request(frame);
  place_bodies(trajectory_, times_.at(frame), renderer, truth_);
  const PingImage rendered =
      server::image_of(ping.ping_number, renderer.render_ping(ping, place_.head), std::nullopt);
  const DirectionRanges sent = survey_->measured(rendered.directions);
  auto image = std::make_shared<const picture::DirectionImage>(image_of(sent));
  const npy::Table points = points_of(*image);
  Frame made;
  made.view = {.time_ns = times_.at(frame), .range_m = ping.settings.range.max_range_m()};
  made.view.add(renderer.last_statistics());
  made.npy = npy::encode(table_of(sent));
  made.more = {{name(frame) + "_points.npy", npy::encode(points)}, {name(frame) + ".ply", ply_of(points)}};
  if (truth_ != nullptr) {
    made.bodies_npy = npy::encode(truth_->table(sent.rows, sent.columns, bodies_of(sent, ping)));
  }
  made.sidecar = sidecar(frame, ping);
  made.draw = [this, image, frame] {
    return picture::draw(*image, options_.radius_px,
                         fmt::format("{}   ping {}   {:.3f} s   {:.1f} m", head_.name, frame,
                                     1e-9 * static_cast<double>(times_.at(frame)), image->most_range_m));
  };
  return made;
}

/// 0 also where the head sends no echo.
std::vector<std::uint16_t> DirectionFrames::bodies_of(const DirectionRanges& sent,
                                                      const render::PingRequest& ping) {
  std::vector<std::uint16_t> ids = truth_->bodies_in(ping);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    ids[i] = sent.range_m[i] > 0.0F ? ids[i] : std::uint16_t{0};
  }
  return ids;
}

std::vector<PingSent> DirectionFrames::pings(int frame, std::string_view npy) const {
  const Result<npy::Table, std::string> table = npy::parse(npy);
  const std::size_t count = job_.directions.count();
  if (!table || table->rows != 2 * job_.directions.rows || table->f32.size() != 2 * count) {
    return {};
  }
  const auto middle = table->f32.begin() + static_cast<std::ptrdiff_t>(count);
  const DirectionRanges sent{job_.directions.columns,
                             job_.directions.rows,
                             {table->f32.begin(), middle},
                             {middle, table->f32.end()}};
  return {sent_ping(survey_->record_of_measured(frame, sent, unix_ns(frame)), unix_ns(frame),
                    trajectory_.T_world_vehicle(times_.at(frame)), head_)};
}

Json DirectionFrames::settings_json() const {
  Json settings = survey_->settings_json();
  add_times(settings, times_, options_);
  return settings;
}

std::string DirectionFrames::sidecar(int frame, const render::PingRequest& request) const {
  const Directions& directions = job_.directions;
  Json json =
      frame_json({frame, head_.name, std::string(head_.type->name()), times_.at(frame), unix_ns(frame)});
  json["ping_number"] = frame;
  json["head_index"] = place_.head;
  if (options_.draws(frame)) {
    json["picture"] = picture_name(name(frame));
  }
  json["samples"] = {{"file", npy_name(name(frame))},
                     {"dtype", "<f4"},
                     {"axes", {"ranges in metres by row, then signals by row", "column"}},
                     {"shape", {2 * directions.rows, directions.columns}}};
  json["points"] = {{"file", name(frame) + "_points.npy"},
                    {"ply", name(frame) + ".ply"},
                    {"axes", "x forward, y to starboard, z down, in metres; signal"}};
  json["geometry"] = {{"columns", directions.columns},
                      {"rows", directions.rows},
                      {"horizontal_fov_rad", directions.horizontal_fov_rad},
                      {"vertical_fov_rad", directions.vertical_fov_rad},
                      {"range_m", job_.range_m()},
                      {"sound_speed_mps", job_.sound_speed_mps}};
  json["settings"] = settings_json();
  json["T_world_vehicle"] = pose_json(trajectory_.T_world_vehicle(times_.at(frame)));
  json["T_world_sonar"] = pose_json(request.T_world_sonar);
  json["truth"] = truth_json(name(frame), truth_);
  return sidecar_text(json);
}

}  // namespace sonard::server
