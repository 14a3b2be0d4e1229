// SPDX-License-Identifier: Apache-2.0
#include "server/web/metrics.hpp"

#include <initializer_list>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "server/web/json.hpp"

namespace sonard::server {
namespace {

using Labels = std::initializer_list<std::pair<std::string_view, std::string_view>>;

std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == '\n') {
      text += "\\n";
      continue;
    }
    if (c == '\\' || c == '"') {
      text += '\\';
    }
    text += c;
  }
  return text;
}

/// Writes one metric: help and type come before the first value, and only if there is a value.
class Metric {
 public:
  Metric(std::string& out, std::string_view name, std::string_view type, std::string_view help)
      : out_(out), name_(name), type_(type), help_(help) {}

  template <class Number>
  void value(Labels labels, Number number) {
    if (!std::exchange(begun_, true)) {
      out_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name_, help_, name_, type_);
    }
    out_ += name_;
    char before = '{';
    for (const auto& [label, text] : labels) {
      out_ += fmt::format("{}{}=\"{}\"", before, label, escaped(text));
      before = ',';
    }
    out_ += fmt::format("{} {}\n", labels.size() > 0 ? "}" : "", number);
  }

 private:
  std::string& out_;
  std::string_view name_, type_, help_;
  bool begun_ = false;
};

void add_pings(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric pings(out, "sonard_pings_total", "counter", "Pings sent completely.");
  for (const HeadStatus& head : heads) {
    pings.value({{"head", head.name}}, head.counts.pings.sent);
  }
  Metric rate(out, "sonard_pings_per_second", "gauge", "Pings per second over the last five seconds.");
  for (const HeadStatus& head : heads) {
    rate.value({{"head", head.name}}, head.pings_per_s);
  }
  Metric age(out, "sonard_last_ping_age_seconds", "gauge", "Time since the newest ping was sent.");
  for (const HeadStatus& head : heads) {
    if (head.since_last_ping) {
      age.value({{"head", head.name}}, std::chrono::duration<double>(*head.since_last_ping).count());
    }
  }
  Metric rendered(out, "sonard_pings_rendered_total", "counter", "Pings rendered.");
  for (const HeadStatus& head : heads) {
    rendered.value({{"head", head.name}}, head.counts.rendering.pings_rendered);
  }
  Metric without(out, "sonard_pings_without_pose_total", "counter",
                 "Pings not made because no pose was known.");
  for (const HeadStatus& head : heads) {
    without.value({{"head", head.name}}, head.counts.rendering.pings_without_pose);
  }
}

void add_stages(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric metric(out, "sonard_ping_seconds_total", "counter", "Rendering time by stage.");
  for (const HeadStatus& head : heads) {
    const render::StageSeconds& spent = head.counts.rendering.stages;
    const std::initializer_list<std::pair<std::string_view, double>> stages{
        {"visibility", spent.visibility}, {"binning", spent.binning},
        {"multipath", spent.multipath},   {"azimuth_pattern", spent.azimuth_pattern},
        {"pulse", spent.pulse},           {"receiver", spent.receiver}};
    for (const auto& [stage, seconds] : stages) {
      metric.value({{"head", head.name}, {"stage", stage}}, seconds);
    }
  }
}

void add_clients(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric clients(out, "sonard_clients", "gauge", "Clients that sent a message in the last minute.");
  for (const HeadStatus& head : heads) {
    clients.value({{"head", head.name}}, head.clients.size());
  }
  Metric latency(out, "sonard_ping_latency_seconds", "gauge",
                 "Time from the transmission of the newest ping until it was sent.");
  for (const HeadStatus& head : heads) {
    if (head.latency) {
      latency.value({{"head", head.name}}, std::chrono::duration<double>(*head.latency).count());
    }
  }
}

void add_events(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric metric(out, "sonard_head_events_total", "counter",
                "Events counted by the device and its transport: retries, lost lines, bad messages, faults.");
  for (const HeadStatus& head : heads) {
    for (const auto& [part, counters] :
         {std::pair("device", &head.counts.device), std::pair("transport", &head.counts.transport)}) {
      for (const Counter& counter : *counters) {
        if (!counter.name.empty()) {
          metric.value({{"head", head.name}, {"part", part}, {"event", counter.name}}, counter.value);
        }
      }
    }
  }
}

void add_client_faults(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric metric(out, "sonard_client_faults_total", "counter",
                "Messages of clients that the head refuses, ignores or changes.");
  for (const HeadStatus& head : heads) {
    for (const Counter& counter : head.counts.device) {
      if (counter.fault == Counter::Fault::of_client) {
        metric.value({{"head", head.name}, {"event", counter.name}}, counter.value);
      }
    }
  }
}

void add_skipped(std::string& out, const std::vector<HeadStatus>& heads) {
  Metric metric(out, "sonard_skipped_total", "counter",
                "Work skipped because it would not change the image, by rule.");
  for (const HeadStatus& head : heads) {
    for (const render::SkipRuleEntry& entry : render::skip_rules) {
      if (const std::uint64_t count = head.counts.rendering.skipped.of(entry.rule); count > 0) {
        metric.value({{"head", head.name}, {"rule", entry.name}}, count);
      }
    }
  }
}

void add_poses(std::string& out, const std::vector<PoseInputStatus>& inputs) {
  Metric poses(out, "sonard_poses_total", "counter", "Vehicle poses received.");
  for (const PoseInputStatus& input : inputs) {
    poses.value({{"input", input.input}}, input.poses.poses);
  }
  Metric age(out, "sonard_pose_age_seconds", "gauge", "Time since the newest pose was received.");
  for (const PoseInputStatus& input : inputs) {
    if (input.poses.age) {
      age.value({{"input", input.input}}, std::chrono::duration<double>(*input.poses.age).count());
    }
  }
  Metric bad(out, "sonard_bad_pose_messages_total", "counter", "Messages without a usable pose, by reason.");
  for (const PoseInputStatus& input : inputs) {
    bad.value({{"input", input.input}, {"reason", "malformed"}}, input.counters.malformed);
    bad.value({{"input", input.input}, {"reason", "bad_value"}}, input.counters.bad_value);
    bad.value({{"input", input.input}, {"reason", "refused"}}, input.counters.refused);
  }
}

void add_recording(std::string& out, const std::optional<RecordingStatus>& recording) {
  if (!recording) {
    return;
  }
  const RecorderCounters& counters = recording->counters;
  Metric(out, "sonard_recording_on", "gauge", "1 while pings are recorded.").value({}, recording->on ? 1 : 0);
  Metric(out, "sonard_recording_images_total", "counter", "Images received by the recorder.")
      .value({}, counters.images);
  Metric(out, "sonard_recording_images_lost_total", "counter", "Images that could not be written to any log.")
      .value({}, counters.images_lost);
  Metric(out, "sonard_recording_dropped_total", "counter", "Events dropped because the disk is too slow.")
      .value({}, counters.dropped.total());
  Metric(out, "sonard_recording_logs_failed_total", "counter", "Logs that could not be written.")
      .value({}, counters.logs_failed);
}

}  // namespace

std::string metrics_text(const DaemonIdentity& identity, const DaemonStatus& status,
                         std::chrono::duration<double> uptime) {
  std::string out;
  Metric(out, "sonard_info", "gauge", "Version, world and engine of this daemon, as labels.")
      .value({{"version", SONARD_VERSION}, {"world", identity.world}, {"engine", status.engine}}, 1);
  Metric(out, "sonard_uptime_seconds", "gauge", "Time since sonard started.").value({}, uptime.count());
  Metric(out, "sonard_ready", "gauge", "1 if /ready returns 200.")
      .value({}, why_not_ready(status).empty() ? 1 : 0);
  add_pings(out, status.heads);
  add_stages(out, status.heads);
  add_clients(out, status.heads);
  add_events(out, status.heads);
  add_client_faults(out, status.heads);
  add_skipped(out, status.heads);
  add_poses(out, status.inputs);
  add_recording(out, status.recording);
  return out;
}

}  // namespace sonard::server
