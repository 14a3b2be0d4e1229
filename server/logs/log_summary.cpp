// SPDX-License-Identifier: Apache-2.0
#include "server/logs/log_summary.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "protocol/glf/log_time.hpp"
#include "server/logs/capture_summary.hpp"
#include "server/logs/glf_log_reader.hpp"
#include "server/logs/mcap_log_reader.hpp"

namespace sonard::server {
namespace {

void add_pings(LogSummary& log, const LogReader& reader) {
  for (const LoggedHead& logged : reader.heads()) {
    HeadSummary& head = head_of(log, logged.name, logged.type, logged.device_id, logged.scanning);
    for (const LoggedPing& ping : logged.pings) {
      add_ping(head, ping.time_ns, ping.settings);
      include(log, ping.time_ns);
    }
  }
  log.problems = reader.problems();
  log.closed = reader.closed();
  for (const auto& [what, records] : reader.other_records()) {
    count(log, what, records);
  }
}

void summarise_glf(LogSummary& log, const LogFile& file) {
  const GlfLogReader reader(file);
  log.local_time = true;
  add_pings(log, reader);
  if (log.problems.empty() && !reader.view().matches_checksum()) {
    log.problems.emplace_back(
        "damaged: the checksum of the archive does not match; bytes of images without a checksum of their "
        "own, or "
        "of statuses, are wrong");
  }
  const glf::DatIndex& index = reader.view().index();
  for (const glf::RecordEntry& entry : index.records) {
    if (entry.type == glf::RecordType::status) {
      count(log, "statuses");
      if (const auto time_ns = glf::unix_ns(entry.origin.time_s, 0)) {
        include(log, *time_ns);
      }
    }
  }
  if (index.other_records > 0) {
    count(log, "records of other types", index.other_records);
  }
}

void summarise_mcap(LogSummary& log, const LogFile& file) {
  const McapLogReader reader(file);
  add_pings(log, reader);
  const mcap::Summary& summary = reader.reader().summary();
  if (summary.message_count() > 0) {
    include(log, static_cast<std::int64_t>(summary.start_time_ns()));
    include(log, static_cast<std::int64_t>(summary.end_time_ns()));
  }
  for (const auto& [channel, messages] : summary.message_counts) {
    const mcap::Channel* const found = summary.channel(channel);
    const mcap::Schema* const schema = found == nullptr ? nullptr : summary.schema(found->schema_id);
    const std::string name = schema == nullptr ? "unknown" : schema->name;
    if (name != "sonard.log.SonarImage" && name != "sonard.log.ScanLine") {
      count(log, name + " messages", messages);
    }
  }
}

}  // namespace

PingRate ping_rate(const std::vector<std::int64_t>& times_ns) {
  PingRate rate;
  if (times_ns.size() < 2) {
    return rate;
  }
  std::vector<double> intervals_s;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    intervals_s.push_back(1e-9 * static_cast<double>(times_ns[i] - times_ns[i - 1]));
  }
  std::ranges::sort(intervals_s);
  rate.median_interval_s = intervals_s[intervals_s.size() / 2];
  const auto first_gap = std::ranges::upper_bound(intervals_s, 2.0 * rate.median_interval_s);
  rate.gaps = static_cast<std::uint64_t>(intervals_s.end() - first_gap);
  rate.longest_gap_s = rate.gaps > 0 ? intervals_s.back() : 0.0;
  return rate;
}

LogSummary summarise(const LogFile& file, const PingFinder& ping_in, const PacketLogOpener& open_packet_log) {
  LogSummary log;
  log.path = file.path().string();
  log.kind = file.kind();
  log.size_bytes = file.bytes().size();
  switch (file.kind()) {
    case LogKind::glf:
    case LogKind::dat:
      summarise_glf(log, file);
      break;
    case LogKind::mcap:
      summarise_mcap(log, file);
      break;
    case LogKind::pcapng:
      summarise_capture(log, file, ping_in);
      break;
    case LogKind::sonar:
      add_pings(log, *open_packet_log(file));
      log.closed.reset();
      break;
  }
  for (HeadSummary& head : log.heads) {
    std::ranges::sort(head.times_ns);
  }
  return log;
}

void add_ping(HeadSummary& head, std::int64_t time_ns, const RecordedSettings& settings) {
  head.times_ns.push_back(time_ns);
  // Searched from the newest: settings seldom change.
  const auto known = std::find_if(head.settings.rbegin(), head.settings.rend(),
                                  [&](const SettingsCount& count) { return count.settings == settings; });
  if (known != head.settings.rend()) {
    ++known->pings;
  } else {
    head.settings.push_back({settings, 1});
  }
}

HeadSummary& head_of(LogSummary& log, const std::string& name, const std::string& type, std::uint16_t id,
                     bool scanning) {
  const auto known = std::ranges::find_if(log.heads, [&](const HeadSummary& head) {
    return head.name == name && head.type == type && head.id == id && head.scanning == scanning;
  });
  return known != log.heads.end() ? *known
                                  : log.heads.emplace_back(HeadSummary{name, type, id, scanning, {}, {}});
}

void include(LogSummary& log, std::int64_t time_ns) {
  if (!plausible_time(time_ns)) {
    return;
  }
  const auto before = log.span_ns.value_or(std::pair{time_ns, time_ns});
  log.span_ns = {std::min(before.first, time_ns), std::max(before.second, time_ns)};
}

void count(LogSummary& log, const std::string& what, std::uint64_t records) {
  const auto known =
      std::ranges::find(log.other_records, what, &std::pair<std::string, std::uint64_t>::first);
  if (known != log.other_records.end()) {
    known->second += records;
  } else {
    log.other_records.emplace_back(what, records);
  }
}

}  // namespace sonard::server
