// SPDX-License-Identifier: Apache-2.0
#include "server/devices/types/types.hpp"

#include <algorithm>
#include <vector>

#include "server/recording/glf_device.hpp"

namespace sonard::server {

std::span<const HeadType* const> head_types() {
  static const std::vector<const HeadType*> types(device_types().begin(), device_types().end());
  return types;
}

const DeviceType* type_named(std::string_view name) {
  const auto types = device_types();
  const auto found = std::ranges::find(types, name, &DeviceType::name);
  return found == types.end() ? nullptr : *found;
}

const DeviceType* type_of_logged(std::string_view name, bool scanning, LogKind log) {
  if (!name.empty()) {
    return type_named(name);
  }
  if (log != LogKind::glf && log != LogKind::dat) {
    return nullptr;
  }
  const auto types = device_types();
  const auto found = std::ranges::find_if(types, [&](const DeviceType* type) {
    return glf_device(*type) != nullptr && type->scanning() == scanning;
  });
  return found == types.end() ? nullptr : *found;
}

std::unique_ptr<LogReader> open_packet_log(const LogFile& file) {
  for (const DeviceType* type : device_types()) {
    const auto* const owner = dynamic_cast<const PacketLogDevice*>(type);
    if (owner != nullptr && owner->packet_log() == file.kind()) {
      return owner->open_packet_log(file);
    }
  }
  throw file.error("is a log of no known device");
}

std::optional<CapturedPing> ping_in(std::span<const std::uint8_t> datagram) {
  for (const DeviceType* type : device_types()) {
    const auto* const reader = dynamic_cast<const CaptureReader*>(type);
    if (auto seen = reader != nullptr ? reader->ping_in(datagram) : std::nullopt) {
      return seen;
    }
  }
  return std::nullopt;
}

}  // namespace sonard::server
