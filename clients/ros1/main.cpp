// SPDX-License-Identifier: Apache-2.0
// roscast: passes poses of a ROS 1 system on to sonard.
#include <fmt/format.h>

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "clients/posecast/pose_link.hpp"
#include "clients/ros1/messages/ros_node.hpp"
#include "clients/ros1/options.hpp"
#include "clients/ros1/pose_bridge.hpp"

namespace sonard::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

constexpr int exit_done = 0;
constexpr int exit_failed = 1;
constexpr milliseconds patience{20};  // between two looks at signals and at the TCP connection
constexpr seconds between_checks{2};  // of the master and its topics
constexpr seconds silence{5};         // of a topic, before it is said
constexpr seconds between_complaints{10};

constexpr const char* odometry_type = "nav_msgs/Odometry";

void say(const std::string& line) {
  fmt::print(stderr, "roscast: {}\n", line);
}

/// The program between its start and its end. One thread: what ROS has heard is handed out by spin().
class Roscast {
 public:
  explicit Roscast(const RoscastOptions& options)
      : options_(options),
        signals_(io_, SIGINT, SIGTERM),
        link_(connect(io_, options.destination, [this](const std::string& what) { fail(what); })),
        bridge_(
            options.bridge, [this](const pose::PoseSample& sample) { link_->send(sample); }, say) {
    signals_.async_wait([this](const boost::system::error_code& cancelled, int) { ended_ = !cancelled; });
  }

  /// @return the exit status.
  int run() {
    wait_for_master();
    if (!over()) {
      serve();
    }
    const BridgeCounters& seen = bridge_.counters();
    const LinkCounters& sent = link_->counters();
    fmt::print(
        "roscast: {} poses to {}, {} refused, {} skipped; wrong_frame={} no_stamp={} bad_value={} "
        "clock_resets={}\n",
        sent.sent, link_->description(), sent.refused, sent.skipped, seen.wrong_frame, seen.no_stamp,
        seen.bad_value, seen.clock_resets);
    if (!failure_.empty()) {
      say(failure_);
      return exit_failed;
    }
    return exit_done;
  }

 private:
  bool over() const { return ended_ || !failure_.empty(); }
  void fail(const std::string& what) { failure_ = what; }

  /// A roscore may be started later; no sign of life until then would look like a bridge that works.
  void wait_for_master() {
    steady_clock::time_point said;
    while (!over() && !ros_master_answers()) {
      if (steady_clock::now() - said > between_complaints) {
        said = steady_clock::now();
        say(fmt::format("no ROS master answers at {}; waiting for one (roscore, ROS_MASTER_URI)",
                        ros_master()));
      }
      io_.poll();
      std::this_thread::sleep_for(milliseconds{200});
    }
  }

  void serve() {
    RosNode node{options_.odometry_topic,
                 options_.uses_tf(),
                 {[this](const RosPose& message) { bridge_.on_odometry(message); },
                  [this](const std::vector<RosPose>& transforms, bool is_static) {
                    bridge_.on_transforms(transforms, is_static);
                  }}};
    say(fmt::format("listening to {} at {}, poses go to {}",
                    options_.odometry_topic.empty() ? "/tf" : node.odometry_topic(), ros_master(),
                    link_->description()));
    last_pose_ = next_check_ = steady_clock::now();
    while (!over()) {
      const std::uint64_t before = bridge_.counters().poses;
      node.spin(patience);
      io_.poll();
      const auto now = steady_clock::now();
      if (bridge_.counters().poses != before) {
        last_pose_ = now;
      }
      if (now >= next_check_) {
        next_check_ = now + between_checks;
        check(node, now);
      }
      if (!node.alive() && !over()) {
        fail("ROS has ended this node; another one of the same name, or rosnode kill");
      }
    }
  }

  void check(RosNode& node, steady_clock::time_point now) {
    const bool answers = ros_master_answers();
    if (answers != master_answers_) {
      master_answers_ = answers;
      say(answers ? "the ROS master is back" : fmt::format("the ROS master at {} is gone", ros_master()));
      if (answers) {
        node.subscribe();
      }
    }
    if (!nobody_said_ && link_->counters().refused > 0) {
      nobody_said_ = true;
      say(link_->description() + ": nobody listens there yet");
    }
    if (answers && now - last_pose_ >= between_checks) {
      check_silence(node, now);
    }
  }

  /// Finds out why there are no poses.
  void check_silence(const RosNode& node, steady_clock::time_point now) {
    const std::map<std::string, std::string> published = RosNode::published();
    const auto topic = published.find(node.odometry_topic());
    // "*": subscribers are there, of any type.
    if (topic != published.end() && topic->second != odometry_type && topic->second != "*") {
      fail(fmt::format("{} carries {}, not {}", topic->first, topic->second, odometry_type));
    } else if (now - last_pose_ >= silence && now - complained_ >= between_complaints) {
      complained_ = now;
      say(reason_of_silence(node.odometry_topic(), published));
    }
  }

  std::string reason_of_silence(const std::string& topic,
                                const std::map<std::string, std::string>& published) const {
    if (topic.empty()) {
      return published.contains("/tf") ? "no poses from /tf: " + bridge_.why_no_vehicle()
                                       : "no poses: nobody publishes /tf";
    }
    if (published.contains(topic)) {
      return fmt::format(
          "no poses from {}, though someone publishes it: is it silent, or does ROS_IP or "
          "ROS_HOSTNAME there name an address that is not reached from here?",
          topic);
    }
    std::string others;
    for (const auto& [name, type] : published) {
      others += type == odometry_type ? " " + name : "";
    }
    return fmt::format("no poses: nobody publishes {}; topics of {}:{}", topic, odometry_type,
                       others.empty() ? " none" : others);
  }

  RoscastOptions options_;
  boost::asio::io_context io_;
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
  boost::asio::signal_set signals_;
  bool ended_ = false;
  std::string failure_;
  std::unique_ptr<PoseLink> link_;
  PoseBridge bridge_;
  bool master_answers_ = true;
  bool nobody_said_ = false;
  steady_clock::time_point last_pose_;
  steady_clock::time_point next_check_;
  steady_clock::time_point complained_;
};

}  // namespace
}  // namespace sonard::client

int main(int argc, char** argv) {
  using namespace sonard::client;
  initialize_ros(argc, argv);
  int exit_status = 0;
  const std::optional<RoscastOptions> options = read_roscast_options(argc, argv, exit_status);
  if (!options) {
    return exit_status;
  }
  try {
    return Roscast{*options}.run();
  } catch (const LinkError& error) {
    fmt::print(stderr, "roscast: {}\n", error.what());
    return exit_failed;
  }
}
