// SPDX-License-Identifier: Apache-2.0
#include "server/listen.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/io_context.hpp>

#include "common/text/printable.hpp"
#include "server/clock/clock.hpp"
#include "server/daemon/exit_codes.hpp"
#include "server/diagnosis/pose_stream.hpp"
#include "server/error/error.hpp"
#include "server/pose/pose_input.hpp"
#include "server/pose/pose_inputs.hpp"
#include "server/pose/posed_body.hpp"
#include "server/pose/to_render.hpp"
#include "server/trial_pings.hpp"

namespace sonard::server {
namespace {

double seconds(std::chrono::nanoseconds time) {
  return 1e-9 * static_cast<double>(time.count());
}

/// Roll, pitch and yaw as in the configuration: about fixed x, y, z; positive pitch is nose down.
std::string angles_text(const pose::Quat& q) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  const double sine = std::fmin(1.0, std::fmax(-1.0, 2 * (q.w * q.y - q.x * q.z)));
  return fmt::format("roll {:.1f}, pitch {:.1f}, yaw {:.1f} degrees",
                     degrees * std::atan2(2 * (q.w * q.x + q.y * q.z), 1 - 2 * (q.x * q.x + q.y * q.y)),
                     degrees * std::asin(sine),
                     degrees * std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)));
}

std::vector<std::string> names_of(const std::vector<pose::NamedTransform>& bodies) {
  std::vector<std::string> names;
  for (const pose::NamedTransform& body : bodies) {
    names.push_back(body.name);
  }
  return names;
}

void print_names(const char* what, const std::vector<std::string>& names) {
  if (!names.empty()) {
    fmt::print("  {} {}\n", what, printable(fmt::format("{}", fmt::join(names, ", "))));
  }
}

void print_newest(const pose::PoseSample& sample) {
  const pose::Vec3& p = sample.T_world_vehicle.position_m;
  fmt::print("  vehicle  last at ({:.3f}, {:.3f}, {:.3f}) m east, north, up; {}; stamp {:.3f} s\n", p.x, p.y,
             p.z, angles_text(sample.T_world_vehicle.orientation),
             1e-9 * static_cast<double>(sample.time_ns));
  print_names("bodies  ", names_of(sample.bodies));
}

/// The likely reason why an input has given no pose.
std::string likely_cause(const PoseSource& source) {
  const PoseSourceCounters& counters = source.counters();
  if (counters.bad_value > 0) {
    return fmt::format("{} messages had no usable pose (the log gives the reasons)", counters.bad_value);
  }
  if (counters.malformed > 0) {
    return fmt::format("{} messages have another format (the log gives the reasons)", counters.malformed);
  }
  if (counters.refused > 0) {
    return "all messages were refused: is the sender in the `allow` list?";
  }
  if (counters.connections > 0) {
    return "a publisher connected but sent no complete message";
  }
  return source.silence_hint();
}

/// Prints each head's view from a received pose, and findings about it.
void print_places(const DaemonConfig& config, const render::World& world, const pose::PoseSample& sample) {
  std::vector<PosedBody> moved;
  for (const pose::NamedTransform& body : sample.bodies) {
    moved.push_back({body.name, to_render(body.T_world_body)});
  }
  TrialPings pings(config, world);
  for (std::size_t i = 0; i < config.heads.size(); ++i) {
    fmt::print("  looks    head '{}': {}\n", printable(config.heads[i].name),
               pings.view(i, to_render(sample.T_world_vehicle), moved));
    for (const Finding& finding : pings.ping(i, to_render(sample.T_world_vehicle), moved)) {
      fmt::print("  wrong?   head '{}': {}\n", printable(config.heads[i].name), printable(finding.text));
    }
  }
}

void print_input(const PoseInputs& inputs, std::size_t index, TimePoint now) {
  const PoseSource& source = inputs.source(index);
  const PoseStatistics& statistics = inputs.statistics(index);
  const std::optional<PublisherId> publisher = source.publisher();
  fmt::print("{}{}\n", printable(source.description()), publisher ? " from " + to_string(*publisher) : "");
  print_names("names   ", source.entities());
  if (statistics.newest()) {
    fmt::print("  {}\n", to_string(statistics.in_all(now)));
    print_newest(*statistics.newest());
  } else {
    fmt::print("  no pose of the vehicle: {}\n", likely_cause(source));
  }
  if (const std::string details = source.details(); !details.empty()) {
    fmt::print(" {}\n", printable(details));
  }
  for (const Finding& finding : look_at_stream(inputs, index, now)) {
    fmt::print("  wrong?   {}\n", printable(finding.text));
  }
}

bool any_is_live(const PoseConfig& poses) {
  return std::ranges::any_of(poses.inputs, [](const auto& input) { return input->type().is_live; });
}

}  // namespace

int listen_to_poses(const DaemonConfig& config, const render::World& world,
                    std::chrono::nanoseconds duration) {
  if (!any_is_live(config.poses)) {
    fmt::print("nothing to listen to: the configuration has no live pose input\n");
    return exit_config;
  }
  boost::asio::io_context io;
  const SteadyClock clock;
  bool any = false;
  try {
    PoseInputs inputs(io, config.poses, clock, [&](const pose::PoseSample&, TimePoint) { any = true; });
    inputs.start();
    fmt::print("listening for {:.1f} s\n", seconds(duration));
    std::fflush(stdout);
    io.run_for(duration);
    const TimePoint now = clock.now();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
      print_input(inputs, i, now);
      if (const auto& newest = inputs.statistics(i).newest()) {
        print_places(config, world, *newest);
      }
    }
    inputs.stop();
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", printable(error.what()));
    return exit_network;
  }
  return any ? exit_clean : exit_config;
}

}  // namespace sonard::server
