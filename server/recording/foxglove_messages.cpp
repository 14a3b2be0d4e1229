// SPDX-License-Identifier: Apache-2.0
#include "server/recording/foxglove_messages.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <utility>

namespace sonard::server {
namespace {

void set(google::protobuf::Timestamp& timestamp, std::int64_t time_ns) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  const std::int64_t seconds = time_ns / second_ns - (time_ns % second_ns < 0 ? 1 : 0);
  timestamp.set_seconds(seconds);
  timestamp.set_nanos(static_cast<std::int32_t>(time_ns - seconds * second_ns));
}

/// The centre of a bin, in the plane through the acoustic axis.
EchoPoint point_at(const PingRecord& ping, std::size_t bin, std::size_t beam) {
  const double range_m = (static_cast<double>(bin) + 0.5) * ping.settings.bin_m;
  const double bearing_rad = ping.bearings_rad[beam];  // positive to starboard
  const std::uint8_t sample = ping.samples[bin * ping.bearings_rad.size() + beam];
  return {static_cast<float>(range_m * std::cos(bearing_rad)),
          static_cast<float>(-range_m * std::sin(bearing_rad)), 0.0F, static_cast<float>(sample)};
}

std::size_t strongest_bin(const PingRecord& ping, std::size_t beam) {
  const std::size_t beams = ping.bearings_rad.size();
  std::size_t strongest = 0;
  for (std::size_t bin = 1; (bin + 1) * beams <= ping.samples.size(); ++bin) {
    if (ping.samples[bin * beams + beam] > ping.samples[strongest * beams + beam]) {
      strongest = bin;
    }
  }
  return strongest;
}

void append(std::string& data, const EchoPoint& point) {
  std::array<char, sizeof(EchoPoint)> bytes;
  std::memcpy(bytes.data(), &point, bytes.size());
  data.append(bytes.data(), bytes.size());
}

}  // namespace

foxglove::CompressedImage foxglove_image(std::string jpeg, const std::string& head, std::int64_t time_ns) {
  foxglove::CompressedImage image;
  set(*image.mutable_timestamp(), time_ns);
  image.set_frame_id(head);
  image.set_data(std::move(jpeg));
  image.set_format("jpeg");
  return image;
}

foxglove::FrameTransform foxglove_transform(const render::Pose& T_world_sonar, const std::string& head,
                                            std::int64_t time_ns) {
  foxglove::FrameTransform transform;
  set(*transform.mutable_timestamp(), time_ns);
  transform.set_parent_frame_id("world");
  transform.set_child_frame_id(head);
  foxglove::Vector3& translation = *transform.mutable_translation();
  translation.set_x(T_world_sonar.position_m.x);
  translation.set_y(T_world_sonar.position_m.y);
  translation.set_z(T_world_sonar.position_m.z);
  foxglove::Quaternion& rotation = *transform.mutable_rotation();
  rotation.set_x(T_world_sonar.orientation.x);
  rotation.set_y(T_world_sonar.orientation.y);
  rotation.set_z(T_world_sonar.orientation.z);
  rotation.set_w(T_world_sonar.orientation.w);
  return transform;
}

foxglove::PointCloud foxglove_echoes(const PingRecord& ping, const std::string& head, std::int64_t time_ns) {
  foxglove::PointCloud cloud;
  set(*cloud.mutable_timestamp(), time_ns);
  cloud.set_frame_id(head);
  cloud.mutable_pose()->mutable_position();
  cloud.mutable_pose()->mutable_orientation()->set_w(1.0);
  cloud.set_point_stride(sizeof(EchoPoint));
  std::uint32_t offset = 0;
  for (const char* const name : {"x", "y", "z", "intensity"}) {
    foxglove::PackedElementField& field = *cloud.add_fields();
    field.set_name(name);
    field.set_offset(offset);
    field.set_type(foxglove::PackedElementField::FLOAT32);
    offset += sizeof(float);
  }
  std::string data;
  if (ping.points) {
    for (const EchoPoint& point : *ping.points) {
      append(data, point);
    }
  } else if (ping.settings.beams == 1) {
    for (std::size_t bin = 0; bin < ping.samples.size(); ++bin) {
      append(data, point_at(ping, bin, 0));
    }
  } else if (!ping.samples.empty()) {
    for (std::size_t beam = 0; beam < ping.bearings_rad.size(); ++beam) {
      append(data, point_at(ping, strongest_bin(ping, beam), beam));
    }
  }
  cloud.set_data(std::move(data));
  return cloud;
}

}  // namespace sonard::server
