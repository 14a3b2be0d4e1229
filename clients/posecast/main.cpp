// SPDX-License-Identifier: Apache-2.0
// posecast: plays a trajectory file as a pose stream for sonard, like a simulator.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include "clients/posecast/caster.hpp"
#include "clients/posecast/pose_link.hpp"
#include "common/command_line/help_formatter.hpp"
#include "common/text/counted.hpp"
#include "common/text/printable.hpp"
#include "protocol/pose/trajectory.hpp"
#include "sonard_build_info.hpp"

namespace {

using namespace sonard;

constexpr int exit_done = 0;
constexpr int exit_network = 1;  // the receiver cannot be reached, or closed the connection
constexpr int exit_usage = 2;    // invalid command line or trajectory file

struct Arguments {
  std::string file;
  std::string to = "127.0.0.1:14600";
  bool tcp = false;
  std::string axes = "enu_flu";
  double rate_hz = 50.0;
  double speed = 1.0;
  bool loop = false;
  double from_s = 0.0;
  double seconds = 0.0;
  bool no_twist = false;
  std::string stamps = "clock";
  double hold_s = 0.0;
  bool quiet = false;
};

void declare(CLI::App& app, Arguments& arguments) {
  const auto positive = CLI::Range(1e-6, 1e6);
  const auto duration = CLI::Range(0.0, 1e9);
  app.footer(
      "Exit status: 0 all poses sent, or ended by Ctrl-C or --seconds; 1 network error; 2 invalid command "
      "line or trajectory.");
  app.add_option("trajectory", arguments.file,
                 "CSV file with the header `t,x,y,z,qx,qy,qz,qw`, or a TUM file")
      ->required();
  app.add_option("--to", arguments.to, "Address of sonard's pose input, HOST:PORT")->capture_default_str();
  app.add_flag("--tcp", arguments.tcp, "Connect by TCP instead of sending UDP datagrams");
  app.add_option("--axes", arguments.axes, "Convention for the axes of world and vehicle in the file")
      ->check(CLI::IsMember({"enu_flu", "ned_frd"}))
      ->capture_default_str();
  app.add_option("--rate", arguments.rate_hz, "Poses per second, interpolated from the file")
      ->check(CLI::Range(1e-3, 1e4))
      ->capture_default_str();
  app.add_option("--speed", arguments.speed, "Playback speed; 2 is twice as fast as recorded")
      ->check(positive)
      ->capture_default_str();
  app.add_flag("--loop", arguments.loop, "Start again at the end");
  app.add_option("--from-time", arguments.from_s, "Start this many seconds into the trajectory")
      ->check(duration);
  app.add_option("--seconds", arguments.seconds, "End after this many seconds")->check(positive);
  app.add_flag("--no-twist", arguments.no_twist, "Send poses without velocity");
  app.add_option("--stamps", arguments.stamps,
                 "Times in the poses: clock is this machine's clock; file is the time in the file. With "
                 "file, every run sends the same poses, and --rate and --seconds count seconds of the file. "
                 "With file and --tcp, posecast waits while the receiver does not read, as in lock-step")
      ->check(CLI::IsMember({"clock", "file"}))
      ->capture_default_str();
  app.add_option("--hold", arguments.hold_s,
                 "First send the first pose for this many seconds, while clients request their pings")
      ->check(duration);
  app.add_flag("--quiet", arguments.quiet, "Print errors only");
}

/// @throws CLI::ValidationError
client::Destination destination(const Arguments& arguments) {
  const auto parsed = client::parse_destination(arguments.to, arguments.tcp);
  if (!parsed) {
    throw CLI::ValidationError("--to",
                               "expected HOST:PORT with a port of 1 to 65535, found '" + arguments.to + "'");
  }
  return *parsed;
}

std::chrono::nanoseconds to_ns(double seconds) {
  return std::chrono::nanoseconds{std::llround(seconds * 1e9)};
}

client::CastSettings settings(const Arguments& arguments, const pose::Trajectory& trajectory) {
  client::CastSettings settings;
  settings.playback = {arguments.speed, arguments.loop, to_ns(arguments.from_s).count()};
  settings.rate_hz = arguments.rate_hz;
  settings.twist = !arguments.no_twist;
  settings.stamps_of_file = arguments.stamps == "file";
  settings.hold = to_ns(arguments.hold_s);
  if (arguments.seconds > 0.0) {
    settings.duration = to_ns(arguments.seconds);
  }
  if (settings.playback.from_ns > trajectory.end_ns() - trajectory.start_ns()) {
    throw CLI::ValidationError("--from-time", "is past the end of the trajectory");
  }
  return settings;
}

/// Casts until the end, a signal or a failure. @return the exit code
int cast(const Arguments& arguments) {
  const pose::Trajectory trajectory = pose::load_trajectory(
      arguments.file, arguments.axes == "ned_frd" ? pose::Axes::ned_frd : pose::Axes::enu_flu);
  const client::CastSettings cast_settings = settings(arguments, trajectory);

  boost::asio::io_context io;
  boost::asio::signal_set signals{io, SIGINT, SIGTERM};
  std::string failure;
  const auto link = client::connect(io, destination(arguments), [&](const std::string& what) {
    failure = what;
    io.stop();
  });
  client::Caster caster{io, trajectory, cast_settings, *link};
  signals.async_wait([&](const boost::system::error_code& cancelled, int) {
    if (!cancelled) {
      io.stop();
    }
  });
  const client::LinkCounters& counters = link->counters();
  boost::asio::steady_timer first_second{io, std::chrono::seconds{1}};
  first_second.async_wait([&](const boost::system::error_code& cancelled) {
    if (!cancelled && counters.refused > 0) {
      fmt::print(
          stderr,
          "posecast: {}: nothing listens there (poses.udp.bind of sonard's configuration sets the address); "
          "continuing\n",
          printable(link->description()));
    }
  });
  const auto began = std::chrono::steady_clock::now();
  caster.start([&] {
    first_second.cancel();
    link->finish([&] { io.stop(); });
  });
  io.run();
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();

  if (!arguments.quiet) {
    fmt::print("posecast: {} in {:.2f} s to {}, {} refused, {} skipped\n", counted(counters.sent, "pose"),
               took_s, printable(link->description()), counters.refused, counters.skipped);
  }
  // The last datagram has no refusal: there was no time for it to arrive.
  if (failure.empty() && counters.refused > 0 && counters.refused + 1 >= counters.sent) {
    failure = link->description() + ": nothing listens there";
  }
  if (!failure.empty()) {
    fmt::print(stderr, "posecast: {}\n", printable(failure));
    return exit_network;
  }
  return exit_done;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Plays a trajectory file as a pose stream for sonard"};
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_version_flag("--version", std::string("posecast " SONARD_BUILD_INFO));
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
    return cast(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? exit_done : exit_usage;
  } catch (const pose::TrajectoryError& error) {
    fmt::print(stderr, "posecast: {}\n", printable(error.what()));
    return exit_usage;
  } catch (const client::LinkError& error) {
    fmt::print(stderr, "posecast: {}\n", printable(error.what()));
    return exit_network;
  }
}
