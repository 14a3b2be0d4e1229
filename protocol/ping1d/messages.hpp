// SPDX-License-Identifier: Apache-2.0
// The messages of a Ping1D or Ping2 as values, both directions.
// Source: protocol/ping1d/README.md 2. Members keep the device's own integers and units. "Client" is the
// other end; "head" is the echo sounder. Multi-byte integers are little-endian. Frame headers are not part of
// a message.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>

#include "protocol/ping/frame.hpp"
#include "protocol/ping/messages.hpp"

namespace sonard::ping1d {

using namespace ping;  // frames and common messages

inline constexpr std::uint8_t default_device_id = 1;  ///< of the head

enum class MessageId : std::uint16_t {
  set_device_id = 1000,
  set_range = 1001,
  set_speed_of_sound = 1002,
  set_mode_auto = 1003,
  set_ping_interval = 1004,
  set_gain_setting = 1005,
  set_ping_enable = 1006,
  goto_bootloader = 1100,
  firmware_version = 1200,
  device_id = 1201,
  voltage_5 = 1202,
  speed_of_sound = 1203,
  range = 1204,
  mode_auto = 1205,
  ping_interval = 1206,
  gain_setting = 1207,
  transmit_duration = 1208,
  general_info = 1210,
  distance_simple = 1211,
  distance = 1212,
  processor_temperature = 1213,
  pcb_temperature = 1214,
  ping_enable = 1215,
  profile = 1300,
  continuous_start = 1400,
  continuous_stop = 1401,
};

/// The name in the published definitions.
constexpr std::string_view name_of(MessageId id) {
  using enum MessageId;
  constexpr std::pair<MessageId, std::string_view> names[] = {
      {set_device_id, "set_device_id"},
      {set_range, "set_range"},
      {set_speed_of_sound, "set_speed_of_sound"},
      {set_mode_auto, "set_mode_auto"},
      {set_ping_interval, "set_ping_interval"},
      {set_gain_setting, "set_gain_setting"},
      {set_ping_enable, "set_ping_enable"},
      {goto_bootloader, "goto_bootloader"},
      {firmware_version, "firmware_version"},
      {device_id, "device_id"},
      {voltage_5, "voltage_5"},
      {speed_of_sound, "speed_of_sound"},
      {range, "range"},
      {mode_auto, "mode_auto"},
      {ping_interval, "ping_interval"},
      {gain_setting, "gain_setting"},
      {transmit_duration, "transmit_duration"},
      {general_info, "general_info"},
      {distance_simple, "distance_simple"},
      {distance, "distance"},
      {processor_temperature, "processor_temperature"},
      {pcb_temperature, "pcb_temperature"},
      {ping_enable, "ping_enable"},
      {profile, "profile"},
      {continuous_start, "continuous_start"},
      {continuous_stop, "continuous_stop"}};
  return name_in(names, id);
}

/// A message with one value, which has the name of the message without "set_".
template <MessageId Id, class Value>
struct Single {
  static constexpr MessageId id = Id;
  Value value = 0;

  bool operator==(const Single&) const = default;
};

/// Start and length of the scan.
template <MessageId Id>
struct RangeMessage {
  static constexpr MessageId id = Id;
  std::uint32_t start_mm = 0;
  std::uint32_t length_mm = 0;

  bool operator==(const RangeMessage&) const = default;
};

// ---- Client -> head (2.2)

using SetDeviceId = Single<MessageId::set_device_id, std::uint8_t>;
using SetRange = RangeMessage<MessageId::set_range>;
using SetSpeedOfSound = Single<MessageId::set_speed_of_sound, std::uint32_t>;  ///< mm/s
using SetModeAuto = Single<MessageId::set_mode_auto, std::uint8_t>;            ///< 0 manual, 1 auto
using SetPingInterval = Single<MessageId::set_ping_interval, std::uint16_t>;   ///< ms
using SetGainSetting = Single<MessageId::set_gain_setting, std::uint8_t>;      ///< 0..6
using SetPingEnable = Single<MessageId::set_ping_enable, std::uint8_t>;        ///< 0, 1
using ContinuousStart = Single<MessageId::continuous_start, std::uint16_t>;  ///< id of the stream's messages
using ContinuousStop = Single<MessageId::continuous_stop, std::uint16_t>;

/// Restarts the head by way of its bootloader (3.6).
struct GotoBootloader {
  static constexpr MessageId id = MessageId::goto_bootloader;
  bool operator==(const GotoBootloader&) const = default;
};

using Command = std::variant<Unknown, GeneralRequest, SetCommonDeviceId, SetDeviceId, SetRange,
                             SetSpeedOfSound, SetModeAuto, SetPingInterval, SetGainSetting, SetPingEnable,
                             GotoBootloader, ContinuousStart, ContinuousStop>;

// ---- Head -> client (2.3)

using DeviceId = Single<MessageId::device_id, std::uint8_t>;
using Voltage5 = Single<MessageId::voltage_5, std::uint16_t>;           ///< mV
using SpeedOfSound = Single<MessageId::speed_of_sound, std::uint32_t>;  ///< mm/s
using Range = RangeMessage<MessageId::range>;
using ModeAuto = Single<MessageId::mode_auto, std::uint8_t>;
using PingInterval = Single<MessageId::ping_interval, std::uint16_t>;          ///< ms
using GainSetting = Single<MessageId::gain_setting, std::uint32_t>;            ///< longer than in its command
using TransmitDuration = Single<MessageId::transmit_duration, std::uint16_t>;  ///< us
using ProcessorTemperature = Single<MessageId::processor_temperature, std::uint16_t>;  ///< 0.01 degrees C
using PcbTemperature = Single<MessageId::pcb_temperature, std::uint16_t>;              ///< 0.01 degrees C
using PingEnable = Single<MessageId::ping_enable, std::uint8_t>;

struct FirmwareVersion {
  static constexpr MessageId id = MessageId::firmware_version;
  std::uint8_t device_type = 1;
  std::uint8_t device_model = 1;
  std::uint16_t major = 3;
  std::uint16_t minor = 29;

  bool operator==(const FirmwareVersion&) const = default;
};

struct GeneralInfo {
  static constexpr MessageId id = MessageId::general_info;
  std::uint16_t firmware_major = 3;
  std::uint16_t firmware_minor = 29;
  std::uint16_t voltage_mv = 0;
  std::uint16_t ping_interval_ms = 0;
  std::uint8_t gain_setting = 0;
  std::uint8_t mode_auto = 0;

  bool operator==(const GeneralInfo&) const = default;
};

struct DistanceSimple {
  static constexpr MessageId id = MessageId::distance_simple;
  std::uint32_t distance_mm = 0;
  std::uint8_t confidence_percent = 0;

  bool operator==(const DistanceSimple&) const = default;
};

/// A measurement, and the settings of its ping.
struct Distance {
  static constexpr MessageId id = MessageId::distance;
  std::uint32_t distance_mm = 0;
  std::uint16_t confidence_percent = 0;
  std::uint16_t transmit_duration_us = 0;
  std::uint32_t ping_number = 0;  ///< since the start of the head
  std::uint32_t scan_start_mm = 0;
  std::uint32_t scan_length_mm = 0;
  std::uint32_t gain_setting = 0;

  bool operator==(const Distance&) const = default;
};

/// A measurement with the echoes over range.
struct Profile : Distance {
  static constexpr MessageId id = MessageId::profile;
  std::span<const std::uint8_t> data;  ///< points that divide the scan evenly, nearest first; views the frame

  const Distance& measured() const { return *this; }
  bool operator==(const Profile& other) const;
};

using Report = std::variant<Unknown, Ack, Nack, AsciiText, DeviceInformation, ProtocolVersion,
                            FirmwareVersion, DeviceId, Voltage5, SpeedOfSound, Range, ModeAuto, PingInterval,
                            GainSetting, TransmitDuration, GeneralInfo, DistanceSimple, Distance,
                            ProcessorTemperature, PcbTemperature, PingEnable, Profile>;

}  // namespace sonard::ping1d
