#include "server/logs/recording.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/logs/glf_recording.hpp"
#include "server/logs/mcap_recording.hpp"

namespace sonard::server {

namespace {

template <class Head>
Head& known_or_new(std::vector<Head>& heads, const std::string& name, std::uint16_t device_id) {
  const auto known = std::ranges::find_if(
      heads, [&](const Head& head) { return head.name == name && head.device_id == device_id; });
  if (known != heads.end()) {
    return *known;
  }
  Head& head = heads.emplace_back();
  head.name = name;
  head.device_id = device_id;
  return head;
}

}  // namespace

RecordedHead& Recording::head(const std::string& name, std::uint16_t device_id) {
  return known_or_new(heads_, name, device_id);
}

RecordedScan& Recording::scan(const std::string& name, std::uint16_t device_id) {
  return known_or_new(scans_, name, device_id);
}

void Recording::sort_by_time() {
  for (RecordedHead& head : heads_) {
    std::ranges::stable_sort(head.images, {}, &RecordedImage::time_ns);
  }
  for (RecordedScan& scan : scans_) {
    std::ranges::stable_sort(scan.lines, {}, &RecordedScanLine::time_ns);
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
  throw file.error("has packets, no images (expected a .glf, .dat or .mcap)");
}

}  // namespace sonard::server
