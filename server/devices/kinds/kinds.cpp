// SPDX-License-Identifier: Apache-2.0
#include "server/devices/kinds/kinds.hpp"

#include <algorithm>
#include <vector>

namespace sonard::server {

std::span<const HeadKind* const> head_kinds() {
  static const std::vector<const HeadKind*> kinds(device_kinds().begin(), device_kinds().end());
  return kinds;
}

const DeviceKind* kind_of_type(std::string_view type) {
  const auto kinds = device_kinds();
  const auto found = std::ranges::find(kinds, type, [](const DeviceKind* kind) { return kind->type(); });
  return found == kinds.end() ? nullptr : *found;
}

const DeviceKind* kind_of_logged(std::string_view device, bool scanning, LogKind log) {
  if (!device.empty()) {
    return kind_of_type(device);
  }
  if (log != LogKind::glf && log != LogKind::dat) {
    return nullptr;
  }
  const auto kinds = device_kinds();
  const auto found = std::ranges::find_if(
      kinds, [&](const DeviceKind* kind) { return kind->writes_glf() && kind->scanning() == scanning; });
  return found == kinds.end() ? nullptr : *found;
}

std::optional<PingSeen> ping_in(std::span<const std::uint8_t> datagram) {
  for (const DeviceKind* kind : device_kinds()) {
    if (const std::optional<PingSeen> seen = kind->ping_in(datagram)) {
      return seen;
    }
  }
  return std::nullopt;
}

}  // namespace sonard::server
