// SPDX-License-Identifier: Apache-2.0
#include "server/offline/sidecar.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include <fmt/format.h>

namespace sonard::server {
namespace {

constexpr double sixteen_to_eight_bits = 1.0 / 257.0;

}  // namespace

Json frame_json(const FrameFacts& facts) {
  return {{"frame", facts.number},
          {"head", facts.head},
          {"type", facts.type},
          {"stamp_s", static_cast<double>(facts.stamp_ns) / 1e9},
          {"unix_ns", facts.unix_ns}};
}

Json samples_json(const std::string& name, bool sixteen_bit, const Axis& rows, const Axis& columns) {
  return {{"file", npy_name(name)},
          {"dtype", sixteen_bit ? "<u2" : "|u1"},
          {"axes", {rows.name, columns.name}},
          {"shape", {rows.size, columns.size}}};
}

Json truth_json(const std::string& name, const BodyTruth* truth) {
  if (truth == nullptr) {
    return nullptr;
  }
  Json bodies = Json::array();
  for (const std::string& body : truth->bodies()) {
    bodies.push_back({{"id", bodies.size() + 1}, {"name", body}});
  }
  return {{"file", bodies_name(name)}, {"bodies", bodies}};
}

Json pose_json(const render::Pose& pose) {
  const glm::dvec3& p = pose.position_m;
  const glm::dquat& q = pose.orientation;
  return {{"position_m", {p.x, p.y, p.z}}, {"quaternion_xyzw", {q.x, q.y, q.z, q.w}}};
}

void add_times(Json& settings, const PingTimes& times, const OfflineOptions& options) {
  settings["period_s"] = options.frame_for_each_pose() ? Json(nullptr) : Json(times.period_ns / 1e9);
  if (options.still.value_or(false)) {
    settings["still"] = true;
  }
}

PingSent sent_ping(PingRecord record, std::int64_t unix_ns, const render::Pose& T_world_vehicle,
                   const HeadConfig& head) {
  auto poses = std::make_shared<PosesUsed>();
  poses->time = record.transmit_time = TimePoint{std::chrono::nanoseconds{unix_ns}};
  poses->T_world_vehicle = T_world_vehicle;
  poses->T_world_sonar = T_world_vehicle * head.T_vehicle_sonar;
  return {std::move(record), std::move(poses)};
}

cv::Mat mask_matrix(const npy::Table& ids) {
  return cv::Mat(ids.rows, ids.columns, CV_8UC1, const_cast<std::uint8_t*>(ids.u8.data())).clone();
}

Json clean_json(const std::string& name, bool with_masks, const picture::SectorGeometry& fan) {
  const CleanNames names(name);
  Json grey{{"file", names.grey}, {"rows", "as those of samples"}, {"columns", "as those of samples"}};
  Json in_fan{{"file", names.fan},
              {"size_px", {fan.size().width, fan.size().height}},
              {"apex_px", {fan.apex().x, fan.apex().y}},
              {"metres_per_px", 1.0 / fan.pixels_per_metre()}};
  if (with_masks) {
    grey["mask"] = names.grey_mask;
    in_fan["mask"] = names.fan_mask;
  }
  return {{"grey", grey}, {"fan", in_fan}};
}

std::string sidecar_text(const Json& object) {
  const auto text_of = [](const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
  };
  std::string text;
  for (const auto& [key, value] : object.items()) {
    text += fmt::format("{}\n  {}: {}", text.empty() ? "{" : ",", text_of(key), text_of(value));
  }
  return text + "\n}\n";
}

cv::Mat eight_bit_matrix(const npy::Table& samples) {
  if (samples.u16.empty()) {
    return cv::Mat(samples.rows, samples.columns, CV_8UC1, const_cast<std::uint8_t*>(samples.u8.data()))
        .clone();
  }
  // OpenCV has no matrix of constant data; this one is only read.
  const cv::Mat sixteen(samples.rows, samples.columns, CV_16UC1,
                        const_cast<std::uint16_t*>(samples.u16.data()));
  cv::Mat eight;
  sixteen.convertTo(eight, CV_8UC1, sixteen_to_eight_bits);
  return eight;
}

std::string npy_name(const std::string& name) {
  return name + ".npy";
}
std::string bodies_name(const std::string& name) {
  return name + "_bodies.npy";
}
std::string picture_name(const std::string& name) {
  return name + ".png";
}
std::string sidecar_name(const std::string& name) {
  return name + ".json";
}

}  // namespace sonard::server
