// SPDX-License-Identifier: Apache-2.0
#include "server/logs/recording.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/logs/glf_recording.hpp"
#include "server/logs/mcap_recording.hpp"

namespace sonard::server {

LoggedHead& Recording::head(const std::string& name, std::uint16_t device_id, bool scanning) {
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

void Recording::sort_by_time() {
  for (LoggedHead& head : heads_) {
    std::ranges::stable_sort(head.pings, {}, &LoggedPing::time_ns);
  }
}

std::unique_ptr<Recording> open_recording(const LogFile& file) {
  switch (file.kind()) {
    case LogKind::glf:
    case LogKind::dat:
      return std::make_unique<GlfRecording>(file);
    case LogKind::mcap:
      return std::make_unique<McapRecording>(file);
    case LogKind::pcapng:
      break;
  }
  throw file.error("contains packets, but no images (expected a .glf, .dat or .mcap)");
}

}  // namespace sonard::server
