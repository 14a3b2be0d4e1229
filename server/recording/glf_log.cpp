#include "server/recording/glf_log.hpp"

#include <variant>

#include "protocol/gemini/codec.hpp"
#include "protocol/glf/codec.hpp"
#include "server/recording/gemini_glf.hpp"
#include "server/recording/log_names.hpp"
#include "server/recording/served_pixels.hpp"

namespace sonard::server {

void GlfLog::write(const RecordingEvent& event) {
  if (event.head != head_ || file().failed()) {
    return;
  }
  if (const auto* ping = std::get_if<GeminiPingServed>(&event.what)) {
    write(*ping);
  } else if (const auto* status = std::get_if<GeminiStatusSent>(&event.what)) {
    write(*status, event.time);
  }
}

void GlfLog::write(const GeminiPingServed& ping) {
  const glf::ImageRecord image = to_glf_image({ping.served.ping.head(), served_pixels(ping.served.ping),
                                               setting().unix_ns(ping.transmit_time), ping.gain_percent},
                                              {setting().utc_offset_s, head().gemini_number});
  if (!file().begun()) {
    const std::filesystem::path& directory = setting().config.directory;
    file().begin(dat_path(directory, free_stem(directory, image.origin.time_s, head().name)));
  }
  file().append(glf::encode(image));
}

void GlfLog::write(const GeminiStatusSent& status, TimePoint time) {
  const auto report = gemini::decode_report({status.datagram.data(), status.datagram.size()});
  if (file().begun() && report && std::holds_alternative<gemini::Status>(*report)) {
    file().append(glf::encode(to_glf_status(std::get<gemini::Status>(*report), setting().unix_ns(time),
                                            {setting().utc_offset_s, head().gemini_number})));
  }
}

}  // namespace sonard::server
