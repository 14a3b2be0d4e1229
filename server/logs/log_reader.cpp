// SPDX-License-Identifier: Apache-2.0
#include "server/logs/log_reader.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/logs/glf_log_reader.hpp"
#include "server/logs/mcap_log_reader.hpp"

namespace sonard::server {

LoggedHead& LogReader::head(const std::string& name, std::uint16_t device_id, bool scanning) {
  const auto known = std::ranges::find_if(heads_, [&](const LoggedHead& head) {
    return head.name == name && head.device_id == device_id && head.scanning == scanning;
  });
  if (known != heads_.end()) {
    return *known;
  }
  LoggedHead& head = heads_.emplace_back();
  head.name = name;
  head.device_id = device_id;
  head.scanning = scanning;
  return head;
}

void LogReader::sort_by_time() {
  for (LoggedHead& head : heads_) {
    std::ranges::stable_sort(head.pings, {}, &LoggedPing::time_ns);
  }
}

std::unique_ptr<LogReader> open_log(const LogFile& file, const PacketLogOpener& open_packet_log) {
  switch (file.kind()) {
    case LogKind::glf:
    case LogKind::dat:
      return std::make_unique<GlfLogReader>(file);
    case LogKind::mcap:
      return std::make_unique<McapLogReader>(file);
    case LogKind::sonar:
      return open_packet_log(file);
    case LogKind::pcapng:
      break;
  }
  throw file.error("contains packets, but no images (expected a .glf, .dat, .mcap or .sonar)");
}

}  // namespace sonard::server
