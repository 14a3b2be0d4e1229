// SPDX-License-Identifier: Apache-2.0
// The messages of a Ping360 as values, both directions, one struct per message.
// Source: protocol/ping360/README.md, section numbers beside each struct. Members keep the device's own
// integers and units (units.hpp), so that decode and encode lose nothing. Spare fields are written as zero
// and skipped on reading. "Client" is the other end; "head" is the sonar. Multi-byte integers are
// little-endian. Frame headers are not part of a message.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "protocol/ping/frame.hpp"
#include "protocol/ping/messages.hpp"

namespace sonard::ping360 {

using namespace ping;  // frames and common messages

inline constexpr std::uint8_t default_device_id = 2;  ///< of the head

enum class MessageId : std::uint16_t {
  ack = 1,
  nack = 2,
  ascii_text = 3,
  device_information = 4,
  protocol_version = 5,
  general_request = 6,
  set_common_device_id = 100,
  set_device_id = 2000,
  device_data = 2300,
  auto_device_data = 2301,
  reset = 2600,
  transducer = 2601,
  auto_transmit = 2602,
  motor_off = 2903,
};

/// The name in the published definitions, of an id that only this device has.
constexpr std::string_view name_of(MessageId id) {
  using enum MessageId;
  constexpr std::pair<MessageId, std::string_view> names[] = {{set_device_id, "set_device_id"},
                                                              {device_data, "device_data"},
                                                              {auto_device_data, "auto_device_data"},
                                                              {reset, "reset"},
                                                              {transducer, "transducer"},
                                                              {auto_transmit, "auto_transmit"},
                                                              {motor_off, "motor_off"}};
  return name_in(names, id);
}

// ---- Client -> head

/// Sets the device id. A head also sends it with its current id, in answer to a request (3.1, 3.6).
struct SetDeviceId {
  static constexpr MessageId id = MessageId::set_device_id;
  std::uint8_t device_id = 0;  ///< 1..254

  bool operator==(const SetDeviceId&) const = default;
};

/// Restarts the head (3.5).
struct Reset {
  static constexpr MessageId id = MessageId::reset;
  std::uint8_t bootloader = 0;  ///< 0: skip it, else enter it

  bool operator==(const Reset&) const = default;
};

/// Moves the head and pings there once (3.2). Defaults: the settings of a head at boot (2.3).
struct Transducer {
  static constexpr MessageId id = MessageId::transducer;
  std::uint8_t mode = 1;  ///< clients also send 0
  std::uint8_t gain_setting = 0;
  std::uint16_t angle = 0;  ///< gradians
  std::uint16_t transmit_duration_us = 32;
  std::uint16_t sample_period = 80;  ///< units of 25 ns
  std::uint16_t transmit_frequency_khz = 740;
  std::uint16_t number_of_samples = 1024;
  std::uint8_t transmit = 1;  ///< 0: only moves

  bool operator==(const Transducer&) const = default;
};

/// Scans until stopped (3.3).
struct AutoTransmit {
  static constexpr MessageId id = MessageId::auto_transmit;
  std::uint8_t mode = 1;
  std::uint8_t gain_setting = 0;
  std::uint16_t transmit_duration_us = 32;
  std::uint16_t sample_period = 80;  ///< units of 25 ns
  std::uint16_t transmit_frequency_khz = 740;
  std::uint16_t number_of_samples = 1024;
  std::uint16_t start_angle = 0;   ///< gradians
  std::uint16_t stop_angle = 399;  ///< gradians, clockwise from the start
  std::uint8_t num_steps = 1;      ///< gradians between two pings
  std::uint8_t delay_ms = 0;       ///< additional time between two pings

  bool operator==(const AutoTransmit&) const = default;
};

/// Ends a scan and drops all queued commands (3.4).
struct MotorOff {
  static constexpr MessageId id = MessageId::motor_off;
  bool operator==(const MotorOff&) const = default;
};

using Command = std::variant<Unknown, GeneralRequest, SetCommonDeviceId, SetDeviceId, Reset, Transducer,
                             AutoTransmit, MotorOff>;

// ---- Head -> client

/// A ping of `transducer`, or the current state of the head (3.1, 3.2).
struct DeviceData {
  static constexpr MessageId id = MessageId::device_data;
  std::uint8_t mode = 1;  ///< as commanded
  std::uint8_t gain_setting = 0;
  std::uint16_t angle = 0;  ///< angle of the head, gradians, 0..399
  std::uint16_t transmit_duration_us = 32;
  std::uint16_t sample_period = 80;  ///< units of 25 ns
  std::uint16_t transmit_frequency_khz = 740;
  std::uint16_t number_of_samples = 1024;
  std::span<const std::uint8_t> data;  ///< nearest sample first; views the frame; empty: no ping

  bool operator==(const DeviceData& other) const;
};

/// A ping of a scan (3.3). All fields except angle and data are as commanded.
struct AutoDeviceData {
  static constexpr MessageId id = MessageId::auto_device_data;
  std::uint8_t mode = 1;
  std::uint8_t gain_setting = 0;
  std::uint16_t angle = 0;  ///< gradians, 0..399
  std::uint16_t transmit_duration_us = 32;
  std::uint16_t sample_period = 80;  ///< units of 25 ns
  std::uint16_t transmit_frequency_khz = 740;
  std::uint16_t start_angle = 0;
  std::uint16_t stop_angle = 399;
  std::uint8_t num_steps = 1;
  std::uint8_t delay_ms = 0;
  std::uint16_t number_of_samples = 1024;
  std::span<const std::uint8_t> data;  ///< nearest sample first; views the frame

  bool operator==(const AutoDeviceData& other) const;
};

using Report = std::variant<Unknown, Ack, Nack, AsciiText, DeviceInformation, ProtocolVersion, SetDeviceId,
                            DeviceData, AutoDeviceData>;

// ---- Common fields of the four messages about pings

/// Copies mode, gain, pulse, sampling and frequency between messages about pings.
template <class To, class From>
void copy_ping_settings(To& to, const From& from) {
  to.mode = from.mode;
  to.gain_setting = from.gain_setting;
  to.transmit_duration_us = from.transmit_duration_us;
  to.sample_period = from.sample_period;
  to.transmit_frequency_khz = from.transmit_frequency_khz;
  to.number_of_samples = from.number_of_samples;
}

/// Copies sector, step and delay between messages about scans.
template <class To, class From>
void copy_scan_settings(To& to, const From& from) {
  to.start_angle = from.start_angle;
  to.stop_angle = from.stop_angle;
  to.num_steps = from.num_steps;
  to.delay_ms = from.delay_ms;
}

}  // namespace sonard::ping360
