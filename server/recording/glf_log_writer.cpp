// SPDX-License-Identifier: Apache-2.0
#include "server/recording/glf_log_writer.hpp"

#include <algorithm>
#include <variant>

#include "protocol/glf/codec.hpp"
#include "server/recording/glf_device.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {
namespace {

constexpr std::ptrdiff_t most_numbered = 9;

std::uint8_t glf_number(const std::vector<HeadToRecord>& heads, int head) {
  const auto before = std::count_if(heads.begin(), heads.begin() + head,
                                    [](const HeadToRecord& one) { return one.glf != nullptr; });
  return static_cast<std::uint8_t>(std::min(before, most_numbered));
}

}  // namespace

GlfLogWriter::GlfLogWriter(const LogSetting& setting, int head)
    : LogWriter(setting),
      head_(head),
      origin_{setting.utc_offset_s, glf_number(setting.heads, head), this->head().device_id} {}

void GlfLogWriter::write(const RecordingEvent& event) {
  if (event.head != head_ || file().failed()) {
    return;
  }
  if (const auto* ping = std::get_if<PingSent>(&event.what)) {
    write(*ping);
  } else if (const auto* status = std::get_if<StatusSent>(&event.what)) {
    write(*status, event.time);
  }
}

void GlfLogWriter::write(const PingSent& sent) {
  const glf::ImageRecord image = glf_image(sent.ping, setting().unix_ns(sent.ping.transmit_time), origin_);
  if (!file().begun()) {
    const std::filesystem::path& directory = setting().config.directory;
    file().begin(dat_path(directory, free_stem(directory, image.origin.time_s, head().name)));
  }
  file().append(glf::encode(image));
}

void GlfLogWriter::write(const StatusSent& status, TimePoint time) {
  if (!file().begun()) {
    return;
  }
  if (auto record = head().glf->glf_status({status.message.data(), status.message.size()})) {
    record->origin = glf_origin(setting().unix_ns(time), origin_);
    file().append(glf::encode(*record));
  }
}

}  // namespace sonard::server
