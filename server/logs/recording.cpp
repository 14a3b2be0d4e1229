#include "server/logs/recording.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/logs/glf_recording.hpp"
#include "server/logs/mcap_recording.hpp"

namespace sonard::server {

RecordedHead& Recording::head(const std::string& name, std::uint16_t device_id) {
  const auto known = std::ranges::find_if(
      heads_, [&](const RecordedHead& head) { return head.name == name && head.device_id == device_id; });
  return known != heads_.end() ? *known : heads_.emplace_back(RecordedHead{name, device_id, {}, {}});
}

void Recording::sort_images() {
  for (RecordedHead& head : heads_) {
    std::ranges::stable_sort(head.images, {}, &RecordedImage::time_ns);
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
