// SPDX-License-Identifier: Apache-2.0
#include "server/pose/section.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "server/yaml/pose_section.hpp"

namespace sonard::server {
namespace {

using Types = std::span<const PoseSourceType* const>;

/// Keys of the types that are live, or of the others. @param mark stands before and after each
std::vector<std::string> keys_of(Types types, bool live, std::string_view mark) {
  std::vector<std::string> keys;
  for (const PoseSourceType* type : types) {
    if (type->is_live == live) {
      keys.push_back(fmt::format("{0}{1}{0}", mark, type->key));
    }
  }
  return keys;
}

/// "udp, tcp or gazebo".
std::string listed(std::vector<std::string> words, std::string_view conjunction) {
  if (words.size() > 1) {
    const std::string last = std::move(words.back());
    words.pop_back();
    words.back() += fmt::format(" {} {}", conjunction, last);
  }
  return fmt::format("{}", fmt::join(words, ", "));
}

/// As listed(), of `first`, if any, and the keys of all types, the live ones first.
std::string all_listed(Types types, std::string_view first, std::string_view conjunction,
                       std::string_view mark) {
  std::vector<std::string> words;
  if (!first.empty()) {
    words.push_back(fmt::format("{0}{1}{0}", mark, first));
  }
  for (const bool live : {true, false}) {
    for (std::string& key : keys_of(types, live, mark)) {
      words.push_back(std::move(key));
    }
  }
  return listed(std::move(words), conjunction);
}

std::string introduction(Types types) {
  const std::vector<std::string> live = keys_of(types, true, "`");
  return fmt::format(
      "At least one of {} is required. {} cannot be combined with {}. Only one of {} may send poses of the "
      "vehicle at a time.",
      all_listed(types, "initial", "and", "`"), listed(keys_of(types, false, "`"), "and"), listed(live, "or"),
      listed(live, "and"));
}

void read_inputs(YamlSection& section, Types types, const std::filesystem::path& folder, PoseConfig& poses) {
  for (const PoseSourceType* type : types) {
    if (!type->former_key.empty()) {
      section.renamed(type->former_key, type->key);
    }
    section.section(type->key, type->meaning,
                    [&](YamlSection& inner) { poses.inputs.push_back(type->read(inner, folder)); });
  }
}

void check_combination(YamlSection& section, Types types, const PoseConfig& poses) {
  const bool any_live =
      std::ranges::any_of(poses.inputs, [](const auto& input) { return input->type().is_live; });
  for (const std::shared_ptr<const PoseInput>& input : poses.inputs) {
    if (any_live && !input->type().is_live) {
      section.report(input->type().key, "cannot be combined with a live input (expected one of them)");
    }
  }
  if (poses.inputs.empty() && !poses.T_world_vehicle_initial) {
    section.report("initial", fmt::format("no source of poses is given (expected {})",
                                          all_listed(types, "initial", "or", "")));
  }
  if (poses.inputs.empty() && poses.clock != PingClock::wall) {
    section.report("clock", fmt::format("requires poses with time stamps (expected wall, or {} in addition)",
                                        all_listed(types, "", "or", "")));
  }
}

}  // namespace

PoseConfig read_poses(YamlSection& section, Types types, const std::filesystem::path& folder) {
  PoseConfig poses;
  section.introduce(introduction(types));
  section.section(
      "initial",
      "pose until the first one arrives. Without it, and always in simulated time (`clock`), the heads "
      "answer clients but do not ping before the first pose",
      [&](YamlSection& inner) {
        inner.require("position_m", "a list of three numbers");
        read_pose(
            inner, poses.T_world_vehicle_initial.emplace(),
            "origin of the vehicle in the world (x east, y north, z up)",
            "roll, pitch and yaw about the fixed x, y and z axes, in this order. On the vehicle, x is "
            "forward, y to port and z up, so positive pitch is nose down and positive yaw turns to port");
      });
  read_inputs(section, types, folder, poses);
  section.duration("extrapolation_limit_ms", poses.extrapolation_limit, Range::from(0.0, 60'000.0),
                   "time after the newest pose for which sonard follows its twist, if any");
  section.choice("stale", poses.stale_policy,
                 {{"hold", StalePolicy::hold}, {"silence", StalePolicy::silence}},
                 "after `extrapolation_limit_ms`: `hold`: pings continue from the last pose; `silence`: "
                 "pings stop until a pose arrives, and status packets continue");
  section.renamed_value("clock", "source", "simulated");
  section.renamed_value("clock", "lock_step", "simulated_lock_step");
  section.choice("clock", poses.clock,
                 {{"wall", PingClock::wall},
                  {"simulated", PingClock::simulated},
                  {"simulated_lock_step", PingClock::simulated_lock_step}},
                 "`wall`: pings follow the clock of this machine; `simulated`: the stamps of the poses, for "
                 "a simulation that is slow, fast or paused; `simulated_lock_step`: also skips no ping, "
                 "however slow the rendering ([poses.md](poses.md#simulated-time))");
  check_combination(section, types, poses);
  return poses;
}

}  // namespace sonard::server
