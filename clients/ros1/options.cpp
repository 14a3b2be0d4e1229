// SPDX-License-Identifier: Apache-2.0
#include "clients/ros1/options.hpp"

#include <CLI/CLI.hpp>
#include <vector>

namespace sonard::client {
namespace {

struct Arguments {
  std::string odometry;
  std::string world_frame = "world";
  std::string vehicle_frame;
  std::vector<std::string> bodies;
  std::string axes = "enu_flu";
  std::string to = "127.0.0.1:14600";
  bool tcp = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.footer(
      "ROS's own arguments work as for every node (__name:=, __ns:=, TOPIC:=OTHER).\n"
      "Exit status: 0 ended by Ctrl-C; 1 network, or the topic is of another type; 2 command line.");
  app.add_option("--odometry", arguments.odometry,
                 "Take the vehicle's pose and twist from this topic of nav_msgs/Odometry");
  app.add_option("--vehicle-frame", arguments.vehicle_frame,
                 "The vehicle: without --odometry its frame of tf; with it the only child_frame_id to take");
  app.add_option("--world-frame", arguments.world_frame, "The frame that is sonard's world")
      ->capture_default_str();
  app.add_option("--body", arguments.bodies,
                 "Let a body of sonard's world follow a frame of tf: FRAME=BODY; as often as needed");
  app.add_option("--axes", arguments.axes, "Axes of world, vehicle and bodies")
      ->check(CLI::IsMember({"enu_flu", "ned_frd"}))
      ->capture_default_str();
  app.add_option("--to", arguments.to, "Where sonard listens, HOST:PORT")->capture_default_str();
  app.add_flag("--tcp", arguments.tcp, "Connect by TCP instead of sending UDP datagrams");
}

/// @throws CLI::ValidationError
RoscastOptions checked(const Arguments& arguments) {
  RoscastOptions options;
  options.odometry_topic = arguments.odometry;
  options.bridge.world_frame = arguments.world_frame;
  options.bridge.vehicle_frame = arguments.vehicle_frame;
  options.bridge.vehicle_from_odometry = !arguments.odometry.empty();
  options.bridge.axes = arguments.axes == "ned_frd" ? pose::Axes::ned_frd : pose::Axes::enu_flu;
  if (arguments.odometry.empty() && arguments.vehicle_frame.empty()) {
    throw CLI::ValidationError("--odometry TOPIC or --vehicle-frame FRAME",
                               "is needed: where is the vehicle?");
  }
  for (const std::string& text : arguments.bodies) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
      throw CLI::ValidationError("--body", "expected FRAME=BODY, found '" + text + "'");
    }
    const std::string body = text.substr(equals + 1);
    for (const FollowedFrame& other : options.bridge.bodies) {
      if (other.body == body) {
        throw CLI::ValidationError("--body", "'" + body + "' follows two frames");
      }
    }
    options.bridge.bodies.push_back({text.substr(0, equals), body});
  }
  const std::optional<Destination> destination = parse_destination(arguments.to, arguments.tcp);
  if (!destination) {
    throw CLI::ValidationError("--to", "expected HOST:PORT, found '" + arguments.to + "'");
  }
  options.destination = *destination;
  return options;
}

}  // namespace

std::optional<RoscastOptions> read_roscast_options(int argc, char** argv, int& exit_status) {
  CLI::App app{"Passes the pose of a vehicle in ROS 1 on to sonard"};
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
    return checked(arguments);
  } catch (const CLI::ParseError& error) {
    constexpr int exit_usage = 2;
    exit_status = app.exit(error) == 0 ? 0 : exit_usage;
    return std::nullopt;
  }
}

}  // namespace sonard::client
