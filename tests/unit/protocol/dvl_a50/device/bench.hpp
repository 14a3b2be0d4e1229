// SPDX-License-Identifier: Apache-2.0
// A DVL over a flat, level bottom in virtual time. The bench records everything sent.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/dvl_a50/beams.hpp"
#include "protocol/dvl_a50/client.hpp"
#include "protocol/dvl_a50/device.hpp"
#include "protocol/dvl_a50/measurement.hpp"
#include "tests/support/device_bench.hpp"

namespace sonard::dvl_a50 {

using namespace std::chrono_literals;

inline const Peer client_a{json_channel, {0x7F000001, 4000}, 0};
inline const Peer client_b{json_channel, {0x7F000001, 4001}, 0};
inline const Peer pd6_client{1, {0x7F000001, 4002}, 0};
inline const Peer pd4_client{2, {0x7F000001, 4003}, 0};
inline const Peer http_client{3, {0x7F000001, 4004}, 0};
inline const Peer serial_client{4, {}, 0};

/// With all channels, and without noise.
inline DeviceConfig quiet(bool with_serial = false) {
  DeviceConfig config;
  config.pd6_channel = 1;
  config.pd4_channel = 2;
  config.http_channel = 3;
  config.serial_channel = with_serial ? 4 : -1;
  config.beam_noise_mps = 0.0;
  config.beam_noise_factor = 0.0;
  config.position_noise_m = 0.0;
  config.heading_drift_deg_per_min = 0.0;
  config.unix_offset = std::chrono::seconds{1767225600};
  return config;
}

/// The head's readings of a level device: x down, y port, z ahead. @param yaw_rad from north to starboard
inline SensorReadings moving(const Vector& of_device_mps, double yaw_rad = 0.0) {
  SensorReadings readings;
  readings.velocity_mps = {of_device_mps[2], -of_device_mps[1], of_device_mps[0]};
  // Nose down by 90 degrees after a turn about the vertical; ahead is north at yaw 0.
  const double half_rad = (std::numbers::pi / 2 - yaw_rad) / 2, s = std::sqrt(0.5);
  readings.orientation_wxyz = {std::cos(half_rad) * s, -std::sin(half_rad) * s, std::cos(half_rad) * s,
                               std::sin(half_rad) * s};
  return readings;
}

template <class T>
struct At {
  TimePoint time{};
  T report;
};

class Bench : public DeviceBench {
 public:
  explicit Bench(const DeviceConfig& config = quiet())
      : DeviceBench(device, [this](const PingJob& job) { return image_of(job); }), device(config, 0ns) {
    step(SensorsRead{readings});
    step(ClientCame{client_a});
  }

  Device device;
  /// Height of the meeting point of the beams above the bottom; 0: no bottom.
  double height_m = 2.0;
  std::array<bool, 4> blocked{};
  SensorReadings readings = moving({0.5, -0.2, 0.05});

  std::map<std::pair<int, std::uint16_t>, std::string> heard;  ///< by channel and port
  std::map<std::uint16_t, Client> clients;                     ///< of JSON, by port
  std::vector<At<Velocity>> velocities;                        ///< of client_a
  std::vector<At<Position>> positions;
  std::vector<At<ReceivedResponse>> responses;  ///< of all clients

  void say(std::string_view text, const Peer& from = client_a) { receive(from, {text.begin(), text.end()}); }
  /// The answer to a command, which must come at once.
  ReceivedResponse ask(std::string_view command, std::string_view parameters = {},
                       const Peer& from = client_a) {
    const std::size_t before = responses.size();
    say(command_text(command, parameters), from);
    EXPECT_EQ(responses.size(), before + 1) << command;
    return responses.size() > before ? responses.back().report : ReceivedResponse{};
  }
  /// Says a line on the serial line; returns what came back at once.
  std::string serial(std::string_view line) {
    std::string& all = heard[{serial_client.channel, 0}];
    all.clear();
    say(std::string(line) + "\n", serial_client);
    return all;
  }
  void move(const SensorReadings& present) {
    readings = present;
    step(SensorsRead{readings});
  }

  PingImage image_of(const PingJob& job) const {
    if (job.record) {
      return test_image(job, job.bins());
    }
    const Directions& grid = job.directions;
    PingImage image{.number = job.number, .u8 = {}, .u16 = {}, .readings = readings};
    image.directions = {grid.columns, grid.rows, std::vector<float>(grid.count()),
                        std::vector<float>(grid.count())};
    const auto last = static_cast<std::size_t>(grid.columns - 1), top = grid.count() - last - 1;
    const std::array corners{last, std::size_t{0}, top, top + last};
    for (std::size_t beam = 0; beam < 4; ++beam) {
      const double range_m = height_m / beam_cosine;
      image.directions.range_m[corners[beam]] =
          static_cast<float>(blocked[beam] || range_m > job.range_m() ? 0.0 : range_m);
    }
    return image;
  }

 protected:
  void hear(const Outgoing& message) override {
    EXPECT_EQ(message.to, Outgoing::To::peer);
    const std::string text(message.bytes.begin(), message.bytes.end());
    heard[{message.peer.channel, message.peer.remote.port}] += text;
    if (message.peer.channel != json_channel) {
      return;
    }
    EXPECT_LT(text.size(), 2048U);
    EXPECT_TRUE(text.ends_with("\r\n"));
    Client& client = clients[message.peer.remote.port];
    client.on_bytes(message.bytes);
    for (const Report& report : client.take()) {
      note(report, message.peer == client_a);
    }
    EXPECT_EQ(client.unreadable(), 0U);
  }

 private:
  void note(const Report& report, bool of_a) {
    if (const auto* const response = std::get_if<ReceivedResponse>(&report)) {
      responses.push_back({now, *response});
    } else if (const auto* const velocity = std::get_if<Velocity>(&report); velocity != nullptr && of_a) {
      velocities.push_back({now, *velocity});
    } else if (const auto* const position = std::get_if<Position>(&report); position != nullptr && of_a) {
      positions.push_back({now, *position});
    }
  }
};

}  // namespace sonard::dvl_a50
