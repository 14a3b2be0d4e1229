// SPDX-License-Identifier: Apache-2.0
// The messages that all devices of the Ping protocol share, as values, one struct per message.
// Source: protocol/ping360/README.md 2.1. Multi-byte integers are little-endian; spare fields are written as
// zero and skipped on reading.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace sonard::ping {

enum class CommonId : std::uint16_t {
  ack = 1,
  nack = 2,
  ascii_text = 3,
  device_information = 4,
  protocol_version = 5,
  general_request = 6,
  set_common_device_id = 100,
};

/// The name of an id in a list of names.
template <class Id, std::size_t N>
constexpr std::string_view name_in(const std::pair<Id, std::string_view> (&names)[N], Id id) {
  for (const auto& [known, name] : names) {
    if (known == id) {
      return name;
    }
  }
  return "unknown";
}

constexpr std::string_view name_of(CommonId id) {
  using enum CommonId;
  constexpr std::pair<CommonId, std::string_view> names[] = {{ack, "ack"},
                                                             {nack, "nack"},
                                                             {ascii_text, "ascii_text"},
                                                             {device_information, "device_information"},
                                                             {protocol_version, "protocol_version"},
                                                             {general_request, "general_request"},
                                                             {set_common_device_id, "set_common_device_id"}};
  return name_in(names, id);
}

/// A message with an unknown id.
struct Unknown {
  std::uint16_t id = 0;

  bool operator==(const Unknown&) const = default;
};

// ---- Client -> head

/// Requests the message `requested_id` (2.1, 3.1). An empty message with that id is an older form of this
/// request and decodes to it.
struct GeneralRequest {
  static constexpr CommonId id = CommonId::general_request;
  std::uint16_t requested_id = 0;

  bool operator==(const GeneralRequest&) const = default;
};

/// Sets the device id.
struct SetCommonDeviceId {
  static constexpr CommonId id = CommonId::set_common_device_id;
  std::uint8_t device_id = 0;  ///< 1..254

  bool operator==(const SetCommonDeviceId&) const = default;
};

// ---- Head -> client

struct Ack {
  static constexpr CommonId id = CommonId::ack;
  std::uint16_t acked_id = 0;

  bool operator==(const Ack&) const = default;
};

/// A refusal (3.8).
struct Nack {
  static constexpr CommonId id = CommonId::nack;
  std::uint16_t nacked_id = 0;
  std::string text;  ///< the rest of the payload, without a terminator

  bool operator==(const Nack&) const = default;
};

struct AsciiText {
  static constexpr CommonId id = CommonId::ascii_text;
  std::string text;  ///< the whole payload, without a terminator

  bool operator==(const AsciiText&) const = default;
};

struct DeviceInformation {
  static constexpr CommonId id = CommonId::device_information;
  std::uint8_t device_type = 0;      ///< 1 Ping1D, 2 Ping360
  std::uint8_t device_revision = 0;  ///< > 0
  std::uint8_t firmware_major = 0;
  std::uint8_t firmware_minor = 0;
  std::uint8_t firmware_patch = 0;

  bool operator==(const DeviceInformation&) const = default;
};

struct ProtocolVersion {
  static constexpr CommonId id = CommonId::protocol_version;
  std::uint8_t major = 1;
  std::uint8_t minor = 0;
  std::uint8_t patch = 0;

  bool operator==(const ProtocolVersion&) const = default;
};

}  // namespace sonard::ping
