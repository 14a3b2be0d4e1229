// SPDX-License-Identifier: Apache-2.0
#include "server/recording/packet_log_writer.hpp"

#include <filesystem>
#include <variant>

#include "protocol/glf/log_time.hpp"
#include "server/recording/log_names.hpp"

namespace sonard::server {

void PacketLogWriter::write(const RecordingEvent& event) {
  const auto* const wire = std::get_if<WirePassed>(&event.what);
  if (event.head != head_ || wire == nullptr || !wire->to_client || wire->transport != WireTransport::udp) {
    return;
  }
  if (!file().begun()) {
    const std::filesystem::path& directory = setting().config.directory;
    const double time_s = glf::glf_time_s(setting().unix_ns(event.time), setting().utc_offset_s);
    const std::string& name = setting().heads[static_cast<std::size_t>(head_)].name;
    file().begin(sonar_path(directory, free_stem(directory, time_s, name)));
  }
  for (const WirePiece& piece : wire->pieces) {
    file().append({piece.bytes.data(), piece.bytes.size()});
  }
}

}  // namespace sonard::server
