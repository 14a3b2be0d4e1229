// SPDX-License-Identifier: Apache-2.0
// All kinds of device in this program.
#pragma once

#include <span>

#include "server/devices/device_kind.hpp"

namespace sonard::server {

/// In the order of cmake/devices.cmake; the build writes this function.
std::span<const DeviceKind* const> device_kinds();

/// The kinds for the loader of configurations.
std::span<const HeadKind* const> head_kinds();

/// The kind of a type of head; null if there is none.
const DeviceKind* kind_of_type(std::string_view type);

/// The kind of a head in a log: named by the log, or the kind that uses .glf and .dat logs; null if neither
/// is known.
const DeviceKind* kind_of_logged(std::string_view device, bool scanning, LogKind log);

/// The first ping in a datagram of any kind of device.
std::optional<PingSeen> ping_in(std::span<const std::uint8_t> datagram);

}  // namespace sonard::server
