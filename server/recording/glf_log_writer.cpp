// SPDX-License-Identifier: Apache-2.0
#include "server/recording/glf_log_writer.hpp"

#include <variant>

#include "protocol/glf/codec.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {

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

GlfLogOrigin GlfLogWriter::origin() const {
  return {setting().utc_offset_s, head().glf_number.value_or(0), head().device_id};
}

void GlfLogWriter::write(const PingSent& sent) {
  const glf::ImageRecord image = glf_image(sent.ping, setting().unix_ns(sent.ping.transmit_time), origin());
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
  if (auto record = head().glf_status({status.message.data(), status.message.size()})) {
    record->origin = glf_origin(setting().unix_ns(time), origin());
    file().append(glf::encode(*record));
  }
}

}  // namespace sonard::server
