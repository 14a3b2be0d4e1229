// SPDX-License-Identifier: Apache-2.0
// All types of device in this program.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

#include "server/devices/device_type.hpp"
#include "server/logs/log_summary.hpp"

namespace sonard::server {

/// In the order of cmake/devices.cmake; the build writes this function.
std::span<const DeviceType* const> device_types();

/// The types for the loader of configurations.
std::span<const HeadType* const> head_types();

/// The type of this name, or null.
const DeviceType* type_named(std::string_view name);

/// The type of a head in a log: named by the log, or the type that uses .glf and .dat logs; null if neither
/// is known.
const DeviceType* type_of_logged(std::string_view name, bool scanning, LogKind log);

/// Opens a log of a PacketLogDevice. @throws Error as open_log()
std::unique_ptr<LogReader> open_packet_log(const LogFile& file);

/// The start of a ping of any type of device in a datagram; nullopt: the types find none.
std::optional<CapturedPing> ping_in(std::span<const std::uint8_t> datagram);

}  // namespace sonard::server
