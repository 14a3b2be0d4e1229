// SPDX-License-Identifier: Apache-2.0
#include "server/web/json.hpp"

#include <string>
#include <string_view>

#include <fmt/format.h>

namespace sonard::server {

using nlohmann::json;

namespace {

double seconds(std::chrono::nanoseconds time) {
  return std::chrono::duration<double>(time).count();
}

json where_json(const std::optional<render::Pose>& pose) {
  return pose ? placed_json(*pose) : json(nullptr);
}

json findings_json(const std::vector<Finding>& findings) {
  json list = json::array();
  for (const Finding& finding : findings) {
    list.push_back({{"code", finding.code}, {"text", finding.text}});
  }
  return list;
}

json stages_json(const render::StageSeconds& spent) {
  return {{"visibility", 1e3 * spent.visibility}, {"binning", 1e3 * spent.binning},
          {"multipath", 1e3 * spent.multipath},   {"azimuth_pattern", 1e3 * spent.azimuth_pattern},
          {"pulse", 1e3 * spent.pulse},           {"receiver", 1e3 * spent.receiver}};
}

double render_ms(const render::StageSeconds& spent) {
  return 1e3 * (spent.visibility + spent.binning + spent.multipath + spent.azimuth_pattern + spent.pulse +
                spent.receiver);
}

json skipped_json(const render::SkipCounts& skipped) {
  json rules = json::array();
  for (const render::SkipRuleEntry& entry : render::skip_rules) {
    if (const std::uint64_t count = skipped.of(entry.rule); count > 0) {
      rules.push_back(
          {{"rule", entry.name}, {"count", count}, {"unit", entry.counts}, {"why", entry.criterion}});
    }
  }
  return rules;
}

json counters_json(const HeadCounts& counts) {
  json counters = json::array();
  for (const std::vector<Counter>* group : {&counts.device, &counts.transport}) {
    for (const Counter& counter : *group) {
      if (!counter.name.empty()) {
        counters.push_back({{"name", counter.name},
                            {"value", counter.value},
                            {"client_fault", counter.fault == Counter::Fault::of_client}});
      }
    }
  }
  return counters;
}

json clients_json(const HeadStatus& head, TimePoint at) {
  json clients = json::array();
  for (const ClientSeen& client : head.clients) {
    clients.push_back(
        {{"address", client.address == Endpoint{} ? "serial line" : endpoint_text(client.address)},
         {"idle_s", seconds(at - client.last)},
         {"messages", client.pieces}});
  }
  return clients;
}

/// Adds the members that need a requested ping; defaults before the first one.
void add_newest_ping(json& head, const HeadStatus& status) {
  const NewestPing newest = status.newest.value_or(NewestPing{});
  json settings = json::array();
  for (const Setting& setting : newest.settings) {
    settings.push_back({{"name", setting.name}, {"value", setting.value}});
  }
  head["settings"] = std::move(settings);
  head["range_m"] = newest.range_m;
  head["bearing_rad"] = 0.0 - newest.bearing_rad;  // to port, as in REP-103; 0 without a sign
  head["pose"] = where_json(newest.T_world_mount);
  head["aperture"] = {{"azimuth_rad", newest.azimuth_rad}, {"elevation_rad", newest.elevation_rad}};
}

json head_json(const HeadStatus& status, TimePoint at) {
  json head{{"name", status.name},
            {"type", status.type},
            {"scanning", status.scanning},
            {"serves", status.serves},
            {"link_faults", status.link_faults},
            {"clients", clients_json(status, at)},
            {"pings", status.counts.pings.sent},
            {"pings_per_s", status.pings_per_s},
            {"pings_without_pose", status.counts.rendering.pings_without_pose},
            {"render_ms", nullptr},
            {"latency_ms", nullptr},
            {"pose_age_ms", nullptr},
            {"last_ping_age_s", nullptr},
            {"stages_ms", stages_json(status.spent)},
            {"skipped", skipped_json(status.counts.rendering.skipped)},
            {"counters", counters_json(status.counts)},
            {"findings", findings_json(status.findings)}};
  if (status.counts.rendering.pings_rendered > 0) {
    head["render_ms"] = render_ms(status.spent);
  }
  if (status.since_last_ping) {
    head["last_ping_age_s"] = seconds(*status.since_last_ping);
  }
  if (status.latency) {
    head["latency_ms"] = 1e3 * seconds(*status.latency);
  }
  add_newest_ping(head, status);
  return head;
}

json input_json(const PoseInputStatus& status) {
  return {{"input", status.input},
          {"publisher", status.publisher ? to_string(*status.publisher) : ""},
          {"poses", status.poses.poses},
          {"rate_hz", status.poses.rate_hz},
          {"age_s", status.poses.age ? json(seconds(*status.poses.age)) : json(nullptr)},
          {"gaps", status.poses.gaps},
          {"jumps", status.poses.jumps},
          {"clock_restarts", status.poses.clock_restarts},
          {"bad_messages", status.counters.malformed + status.counters.bad_value},
          {"refused", status.counters.refused},
          {"findings", findings_json(status.findings)}};
}

json poses_json(const DaemonStatus& status) {
  json inputs = json::array();
  for (const PoseInputStatus& input : status.inputs) {
    inputs.push_back(input_json(input));
  }
  json bodies = json::array();
  for (const PosedBody& body : status.bodies) {
    json pose = placed_json(body.T_world_body);
    pose["name"] = body.name;
    bodies.push_back(std::move(pose));
  }
  return {{"inputs", std::move(inputs)},
          {"vehicle", where_json(status.T_world_vehicle)},
          {"bodies", std::move(bodies)}};
}

json seconds_json(const std::optional<std::chrono::nanoseconds>& time) {
  return time ? json(seconds(*time)) : json(nullptr);
}

json recording_json(const std::optional<RecordingStatus>& recording) {
  if (!recording) {
    return nullptr;
  }
  const RecorderCounters& counters = recording->counters;
  return {{"directory", recording->directory},   {"on", recording->on},
          {"images", counters.images},           {"images_lost", counters.images_lost},
          {"dropped", counters.dropped.total()}, {"logs_written", counters.logs_written},
          {"logs_failed", counters.logs_failed}};
}

// Empty if the pose of the vehicle is known, and a stamp lets pings begin if they wait for one.
std::string trouble_with_pose(const DaemonStatus& status) {
  if (!status.T_world_vehicle) {
    return status.stale_pose ? stale_text(*status.stale_pose) : "the vehicle has no pose";
  }
  const bool has_stamp = status.ping_clock == PingClock::wall || age_of_poses(status);
  return has_stamp ? "" : "no pose has arrived, and pings follow the stamps of poses (poses.clock)";
}

}  // namespace

json vector_json(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

json placed_json(const render::Pose& pose) {
  const glm::dquat& q = pose.orientation;
  return {{"position_m", vector_json(pose.position_m)}, {"orientation_wxyz", {q.w, q.x, q.y, q.z}}};
}

json status_json(const DaemonIdentity& identity, const DaemonStatus& status,
                 std::chrono::duration<double> uptime) {
  json heads = json::array();
  for (const HeadStatus& head : status.heads) {
    json about = head_json(head, status.at);
    if (const auto age = age_of_poses(status)) {
      about["pose_age_ms"] = 1e3 * seconds(*age);
    }
    heads.push_back(std::move(about));
  }
  const json surface = identity.water_surface_z_m ? json(*identity.water_surface_z_m) : json(nullptr);
  return {{"version", SONARD_VERSION},
          {"configuration", identity.configuration},
          {"uptime_s", uptime.count()},
          {"engine", status.engine},
          {"world", {{"name", identity.world}, {"water_surface_z_m", surface}}},
          {"heads", std::move(heads)},
          {"poses", poses_json(status)},
          {"recording", recording_json(status.recording)}};
}

std::optional<std::chrono::nanoseconds> age_of_poses(const DaemonStatus& status) {
  std::optional<std::chrono::nanoseconds> least;
  for (const PoseInputStatus& input : status.inputs) {
    if (input.poses.age && (!least || *input.poses.age < *least)) {
      least = input.poses.age;
    }
  }
  return least;
}

std::vector<std::string> why_not_ready(const DaemonStatus& status) {
  std::vector<std::string> reasons;
  if (const std::string trouble = trouble_with_pose(status); !trouble.empty()) {
    reasons.push_back(status.inputs.empty()
                          ? trouble
                          : fmt::format("{}: send poses to {}", trouble, status.inputs.front().input));
  }
  for (const PoseInputStatus& input : status.inputs) {
    for (const Finding& finding : input.findings) {
      if (finding.stops_pings) {
        reasons.push_back(fmt::format("{}: {}", input.input, finding.text));
      }
    }
  }
  for (const HeadStatus& head : status.heads) {
    if (head.serves.empty()) {
      reasons.push_back(fmt::format("head '{}' serves no address", head.name));
    }
  }
  return reasons;
}

json readiness_json(const DaemonStatus& status) {
  const std::vector<std::string> reasons = why_not_ready(status);
  json heads = json::array();
  for (const HeadStatus& head : status.heads) {
    heads.push_back({{"name", head.name},
                     {"serves", head.serves},
                     {"clients", head.clients.size()},
                     {"pings", head.counts.pings.sent},
                     {"last_ping_age_s", seconds_json(head.since_last_ping)}});
  }
  return {{"ready", reasons.empty()},
          {"reasons", reasons},
          {"engine", status.engine},
          {"pose_known", status.T_world_vehicle.has_value()},
          {"pose_age_s", seconds_json(age_of_poses(status))},
          {"heads", std::move(heads)}};
}

json json_of_peer(std::string_view text) {
  constexpr int deepest = 16;
  bool too_deep = false;
  const auto keep = [&](int depth, json::parse_event_t, json&) {
    too_deep = too_deep || depth > deepest;
    return !too_deep;
  };
  json value = json::parse(text, keep, /*allow_exceptions=*/false);
  return too_deep ? json(json::value_t::discarded) : value;
}

std::string text_of(const json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace sonard::server
