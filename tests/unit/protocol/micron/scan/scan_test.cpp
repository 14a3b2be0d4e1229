// SPDX-License-Identifier: Apache-2.0
// A Micron in the tank (docs/worlds.md), from the client's command to the bins that it reads, in virtual
// time: head, mapping of pings and renderer, without sockets. The expected values come from the four planes
// of the walls.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <glm/gtc/quaternion.hpp>

#include "protocol/micron/client.hpp"
#include "protocol/micron/device.hpp"
#include "protocol/micron/units.hpp"
#include "renderer/pipeline/sonar_renderer.hpp"
#include "renderer/scene/world.hpp"
#include "server/devices/micron/settings.hpp"
#include "server/devices/micron/type.hpp"
#include "tests/support/degree.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

constexpr double half_beam = 1.5 * degree;
/// Positions of the inner faces of the walls.
constexpr double east_m = 7, west_m = -7, north_m = 5, south_m = -5;
const glm::dvec3 start_m{-1, -0.5, -4};

/// Range of the nearest wall from the start, along a horizontal ray.
double wall_range_m(double world_azimuth_rad) {
  const double c = std::cos(world_azimuth_rad), s = std::sin(world_azimuth_rad);
  const double along_x = c == 0 ? INFINITY : ((c > 0 ? east_m : west_m) - start_m.x) / c;
  const double along_y = s == 0 ? INFINITY : ((s > 0 ? north_m : south_m) - start_m.y) / s;
  return std::min(along_x, along_y);
}

struct Span {
  double nearest_m, furthest_m;
};

/// Range of the wall over the width of the beam around an azimuth, in the horizontal plane.
Span wall_span(double world_azimuth_rad) {
  Span span{INFINITY, 0};
  for (int i = -50; i <= 50; ++i) {
    const double range_m = wall_range_m(world_azimuth_rad + i / 50.0 * half_beam);
    span.nearest_m = std::min(span.nearest_m, range_m);
    span.furthest_m = std::max(span.furthest_m, range_m);
  }
  return span;
}

/// True if an object stands in front of the wall (docs/worlds.md), with half a beam added on either side.
/// Azimuths are counted to port of the bow.
bool sees_furniture(double world_azimuth_rad) {
  const double a = std::remainder(world_azimuth_rad, 2 * std::numbers::pi) / degree;
  const auto between = [a](double low, double high) { return a > low - 1.6 && a < high + 1.6; };
  return between(11, 18) || between(67, 73) || between(155, 165) || between(-66, -54);
}

/// A line of a scan, with its job, which holds bearing and time.
struct Line {
  micron::ReceivedLine received;
  PingJob job;
};

/// Head, renderer and client on one clock, which runs as fast as they do.
class Scan {
 public:
  explicit Scan(HeadConfig config)
      : config_(std::move(config)),
        device_(device_settings<MicronConfig>(config_).device, 0ns),
        client_({}, 0ns),
        renderer_(render::load_world(SONARD_SOURCE_DIR "/configs/worlds/tank.sdf"),
                  {render::EngineKind::cpu, 0}) {}

  /// Yaw of the vehicle. By default it is at rest at the start, bow to the east.
  std::function<double(TimePoint)> yaw_rad = [](TimePoint) { return 0.0; };

  std::vector<Line> run(const micron::HeadCommand& command, std::uint64_t lines) {
    client_.start(now_, command, lines);
    std::vector<Line> scan;
    while (!client_.finished() && now_ < 120s) {
      step();
      for (micron::ReceivedLine& line : client_.take_lines()) {
        const auto job = std::find_if(jobs_.begin(), jobs_.end(), [&](const PingJob& one) {
          return one.bearing_rad == micron::bearing_rad(line.head.bearing) && one.number >= next_job_;
        });
        if (job == jobs_.end()) {
          ADD_FAILURE() << "a line at " << line.head.bearing << " was never rendered";
          return scan;
        }
        next_job_ = job->number + 1;
        scan.push_back({std::move(line), *job});
      }
    }
    return scan;
  }

  TimePoint now() const { return now_; }

 private:
  void step() {
    client_.advance(now_);
    for (const auto& frame : client_.take_outgoing()) {
      happen(BytesReceived{{}, SharedBytes(frame)});
    }
    happen(TimePassed{});
    client_.advance(now_);
    std::optional<TimePoint> next = wake_at_;
    if (const auto other = client_.next_deadline(); other && (!next || *other < *next)) {
      next = other;
    }
    now_ = std::max(now_ + 1us, next.value_or(now_ + 1ms));
  }

  void happen(const Event& event) {
    const Actions actions = device_.step(now_, event);
    wake_at_ = actions.wake_at;
    for (const Outgoing& frame : actions.send) {
      client_.on_bytes(now_, {frame.bytes.data(), frame.bytes.size()});
    }
    if (actions.render) {
      happen(PingRendered{answer(*actions.render)});
    }
  }

  PingImage answer(const PingJob& job) {
    const glm::dquat yaw = glm::angleAxis(yaw_rad(job.transmit_time), glm::dvec3(0, 0, 1));
    const render::Pose T_world_mount = render::Pose{start_m, yaw} * config_.T_vehicle_sonar;
    render::PingSamples samples =
        renderer_.render_ping({T_world_transducer(T_world_mount, job.bearing_rad),
                               micron_sonar_settings(job, config_), job.number, config_.seed});
    jobs_.push_back(job);
    return {job.number, std::move(samples.u8), {}};
  }

  HeadConfig config_;
  TimePoint now_{};
  micron::Device device_;
  micron::Client client_;
  render::SonarRenderer renderer_;
  std::optional<TimePoint> wake_at_;
  std::vector<PingJob> jobs_;
  std::uint64_t next_job_ = 0;
};

/// 400 bins to 10.2 m in steps of 1.8 degrees, a full turn.
micron::HeadCommand all_round() {
  return {};
}

/// No random effects and sharp edges of the beam, so that echoes begin exactly at the surfaces.
HeadConfig plain_head() {
  HeadConfig config = micron_type().make_default();
  auto device = std::make_shared<MicronConfig>();
  device->chirp_bandwidth_hz = 0;
  config.device = std::move(device);
  config.acoustics.physical.noise.on = false;
  config.acoustics.physical.speckle.kind = render::SpeckleSettings::Kind::off;
  config.acoustics.physical.backscatter = render::PhysicalModel::Backscatter::lambert;
  config.acoustics.physical.multipath.level = render::MultipathSettings::Level::off;
  config.acoustics.physical.ring_down.on = false;
  config.acoustics.physical.noise.interference.probability = 0;
  config.acoustics.aperture.elevation = render::Aperture::Elevation::top_hat;
  return config;
}

int first_echo(const Line& line) {
  const auto& bins = line.received.bins;
  return static_cast<int>(std::find_if(bins.begin(), bins.end(), [](std::uint8_t code) { return code > 0; }) -
                          bins.begin());
}

/// Checks every line that sees only wall: its first echo is within one bin of the closed form.
void expect_walls(const std::vector<Line>& scan, const std::function<double(TimePoint)>& yaw_rad) {
  int walls = 0, worst = 0;
  for (const Line& line : scan) {
    const double azimuth = yaw_rad(line.job.transmit_time) - micron::bearing_rad(line.received.head.bearing);
    if (sees_furniture(azimuth)) {
      continue;
    }
    const int expected = static_cast<int>(wall_span(azimuth).nearest_m / line.job.bin_m());
    worst = std::max(worst, std::abs(first_echo(line) - expected));
    EXPECT_LE(std::abs(first_echo(line) - expected), 1)
        << "bearing " << line.received.head.bearing << ", azimuth " << azimuth / degree;
    ++walls;
  }
  std::printf("%d walls in %zu lines, worst off by %d bins\n", walls, scan.size(), worst);
  EXPECT_GT(walls, 160);
}

TEST(MicronScan, AStillHeadHearsTheWallsWhereTheyAre) {
  Scan scan(plain_head());
  const std::vector<Line> lines = scan.run(all_round(), 200);
  ASSERT_EQ(lines.size(), 200u);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    EXPECT_EQ(micron::wrapped(lines[i].received.head.bearing - lines[i - 1].received.head.bearing), 32);
  }
  expect_walls(lines, scan.yaw_rad);
}

// The vehicle turns evenly by 20 degrees during one turn of the head. At each step the picture is rotated by
// the vehicle's yaw at that time.
TEST(MicronScan, AVehicleThatTurnsTwistsTheScan) {
  Scan scan(plain_head());
  constexpr double turn_rad = 20 * degree;
  constexpr TimePoint begin = 6s;  // by then the head is centred and scans
  constexpr std::chrono::duration<double> duration{8.3};
  const auto yaw_rad = [&](TimePoint time) {
    return turn_rad * std::clamp(std::chrono::duration<double>(time - begin) / duration, 0.0, 1.0);
  };
  scan.yaw_rad = yaw_rad;
  const std::vector<Line> lines = scan.run(all_round(), 500);
  ASSERT_EQ(lines.size(), 500u);
  expect_walls(lines, yaw_rad);
  // The south wall, 4.5 m away at 90 degrees to starboard: its bearing in the first turn, and 1.5 turns
  // later.
  const auto south_wall = [&](std::size_t from) {
    double lines_there = 0, bearing = 0, yaw = 0;
    for (std::size_t i = from; i < from + 200; ++i) {
      const double range_m = first_echo(lines[i]) * lines[i].job.bin_m();
      const double at = micron::bearing_rad(lines[i].received.head.bearing);
      if (at > 70 * degree && at < 130 * degree && range_m > 4.4 && range_m < 4.6) {
        ++lines_there;
        bearing += at;
        yaw += yaw_rad(lines[i].job.transmit_time);
      }
    }
    EXPECT_GT(lines_there, 10);
    return std::pair{bearing / lines_there / degree, yaw / lines_there / degree};
  };
  const auto [first_bearing, first_yaw] = south_wall(0);
  const auto [last_bearing, last_yaw] = south_wall(300);
  EXPECT_NEAR(first_bearing, 90 + first_yaw, 0.9);
  EXPECT_NEAR(last_bearing, 90 + last_yaw, 0.9);
  EXPECT_GT(last_bearing - first_bearing, 15);
}

TEST(MicronScan, WithEverythingOnTheStrongestEchoIsTheWall) {
  Scan scan(micron_type().make_default());
  const std::vector<Line> lines = scan.run(all_round(), 200);
  ASSERT_EQ(lines.size(), 200u);
  for (const Line& line : lines) {
    const double azimuth = -micron::bearing_rad(line.received.head.bearing);
    if (sees_furniture(azimuth)) {
      continue;
    }
    const auto& bins = line.received.bins;
    // Beyond the ring-down.
    const auto rings = static_cast<std::ptrdiff_t>(std::ceil(1.0 / line.job.bin_m()));
    const auto strongest = std::max_element(bins.begin() + rings, bins.end());
    const double range_m = (static_cast<double>(strongest - bins.begin()) + 0.5) * line.job.bin_m();
    const Span wall = wall_span(azimuth);
    EXPECT_GT(range_m, wall.nearest_m - 1.5 * line.job.bin_m()) << azimuth / degree;
    // At the elevations of a beam of 35 degrees a wall is up to 7.6 % further.
    EXPECT_LT(range_m, 1.076 * wall.furthest_m + 1.5 * line.job.bin_m()) << azimuth / degree;
    EXPECT_GE(*strongest, 90);   // 28 dB: well above the noise
    EXPECT_LE(*strongest, 191);  // the maximum of an imaging head
  }
}

// protocol/micron/README.md 8.4: 41.6 ms per line with 400 bins, 8.3 s per turn.
TEST(MicronScan, ATurnTakesItsTimeOnTheClockOfTheHead) {
  Scan scan(plain_head());
  const auto started = std::chrono::steady_clock::now();
  const std::vector<Line> lines = scan.run(all_round(), 201);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - started;
  ASSERT_EQ(lines.size(), 201u);
  const std::chrono::duration<double> turn = lines[200].job.transmit_time - lines[0].job.transmit_time;
  std::printf("a turn of 200 lines: %.3f s of the head; rendered at %.0f pings/s\n", turn.count(),
              201 / took.count());
  EXPECT_NEAR(turn.count() / 200, 0.0416, 0.0002);
}

}  // namespace
}  // namespace sonard::server
