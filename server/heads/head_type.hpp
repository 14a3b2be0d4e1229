// SPDX-License-Identifier: Apache-2.0
// What the configuration needs to know of a type of device.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/heads/head_config.hpp"
#include "server/heads/head_section.hpp"
#include "server/net/planned_socket.hpp"
#include "server/net/serial_port.hpp"
#include "server/yaml/yaml_section.hpp"

namespace sonard::server {

/// A value that no two heads may share.
struct Identity {
  std::string key;      ///< of the head: "sonar_id"
  std::string value;    ///< as text: "513"
  bool of_type = true;  ///< heads of different types may share it; false: they may not
};

/// The part of a type of device that the configuration reads, because the configuration must not depend on
/// devices; DeviceType is the whole. One object for each type of device, without state. A head of the
/// configuration points to its type; its `device` holds the settings that this type has read.
class HeadType {
 public:
  HeadType() = default;
  virtual ~HeadType() = default;
  HeadType(const HeadType&) = delete;
  HeadType& operator=(const HeadType&) = delete;

  virtual std::string_view name() const = 0;   ///< as in the configuration: "example_100"
  virtual std::string_view title() const = 0;  ///< for people: "Example 100"
  /// Model names (values of the key `model`) that users may write as the type by mistake.
  virtual std::vector<std::string_view> models() const { return {}; }

  /// A head with the defaults of this type.
  virtual HeadConfig make_default() const = 0;
  /// Reads a section of `heads`, except its type.
  virtual HeadConfig read(YamlSection& section, const HeadContext& context) const = 0;

  virtual std::uint16_t device_id(const HeadConfig& head) const = 0;  ///< on the wire
  virtual std::vector<PlannedSocket> sockets(const HeadConfig& head) const = 0;
  virtual std::vector<Identity> identities(const HeadConfig& head) const = 0;
  /// For `sonard check`: "ID 513, commands to 127.0.0.2:52901, status to 127.0.0.1".
  virtual std::string summary(const HeadConfig& head) const = 0;
  /// Problems that a client on this machine would have with this head; keys are relative to the head.
  virtual std::vector<ConfigWarning> network_warnings(const HeadConfig& /*head*/) const { return {}; }
};

/// Planned sockets of the serial link under a key of a head.
std::vector<PlannedSocket> serial_sockets(const SerialLinkConfig& link, const std::string& key);
/// Identities of the links to its pseudo terminals.
std::vector<Identity> serial_identities(const SerialLinkConfig& link, const std::string& key);

}  // namespace sonard::server
