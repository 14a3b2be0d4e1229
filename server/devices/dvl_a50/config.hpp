// SPDX-License-Identifier: Apache-2.0
// Configuration that only a head of type `dvl_a50` has (docs/configuration.md).
#pragma once

#include <cstdint>
#include <optional>

#include "protocol/dvl_a50/device_config.hpp"
#include "server/heads/device_settings.hpp"
#include "server/heads/head_config.hpp"
#include "server/net/serial_port.hpp"
#include "server/net/tcp_transport.hpp"

namespace sonard::server {

// Ports of a real device (protocol/dvl_a50/README.md).
inline constexpr std::uint16_t dvl_json_port = 16171, dvl_pd6_port = 1037, dvl_pd4_port = 1038;

/// The head looks along the x axis of its mount, and forward along its z axis.
struct DvlConfig final : DeviceSettings {
  dvl_a50::DeviceConfig device;
  TcpTransportConfig json;
  // The channels of the device after the first, in this order.
  std::optional<TcpTransportConfig> pd6, pd4, http;
  SerialLinkConfig serial;  ///< the last channel, if it has ports
};

/// Default acoustics of such a head.
render::SonarSettings dvl_acoustics(dvl_a50::Model model);
/// Frequency of the sound.
double dvl_carrier_hz(dvl_a50::Model model);

}  // namespace sonard::server
