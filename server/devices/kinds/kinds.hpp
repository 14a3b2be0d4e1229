// SPDX-License-Identifier: Apache-2.0
// Every kind of device that this program is built with.
#pragma once

#include <span>

#include "server/devices/device_kind.hpp"

namespace sonard::server {

/// In the order of cmake/devices.cmake, from which the build writes this function.
std::span<const DeviceKind* const> device_kinds();

/// The kinds for the loader of configurations.
std::span<const HeadKind* const> head_kinds();

/// The kind of a type of head; null where there is none.
const DeviceKind* kind_of_type(std::string_view type);

/// The kind of a head of a log: what the log says, or the kind whose users know such logs; null where neither
/// tells.
const DeviceKind* kind_of_logged(std::string_view device, bool scanning, LogKind log);

/// The first ping in a datagram of any kind of device.
std::optional<PingSeen> ping_in(std::span<const std::uint8_t> datagram);

}  // namespace sonard::server
