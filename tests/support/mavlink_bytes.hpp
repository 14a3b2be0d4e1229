// SPDX-License-Identifier: Apache-2.0
// MAVLink frames by the MAVLink guide, made without our codec, so that they check each byte of it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

namespace sonard::test {

using Bytes = std::vector<std::uint8_t>;

/// One step of the checksum, as the C code in the guide ("CRC-16/MCRF4XX"): by halves of a byte, without a
/// table.
inline std::uint16_t mavlink_crc(std::uint16_t crc, std::uint8_t byte) {
  std::uint8_t tmp = static_cast<std::uint8_t>(byte ^ (crc & 0xFFU));
  tmp = static_cast<std::uint8_t>(tmp ^ (tmp << 4U));
  return static_cast<std::uint16_t>((crc >> 8U) ^ (tmp << 8U) ^ (tmp << 3U) ^ (tmp >> 4U));
}

/// A field of a message definition: type, name, number of elements (0: no array).
struct MavlinkField {
  std::string type;
  std::string name;
  int elements = 0;
};

/// CRC_EXTRA by the guide: the folded checksum of the name and the base fields in wire order.
inline std::uint8_t mavlink_seed(const std::string& message, const std::vector<MavlinkField>& fields) {
  std::uint16_t crc = 0xFFFF;
  const auto add = [&](const std::string& text) {
    for (const char character : text) {
      crc = mavlink_crc(crc, static_cast<std::uint8_t>(character));
    }
  };
  add(message + " ");
  for (const MavlinkField& field : fields) {
    add(field.type + " ");
    add(field.name + " ");
    if (field.elements > 0) {
      crc = mavlink_crc(crc, static_cast<std::uint8_t>(field.elements));
    }
  }
  return static_cast<std::uint8_t>((crc & 0xFFU) ^ (crc >> 8U));
}

template <class Value>
void append(Bytes& bytes, Value value) {  // little-endian hosts only
  std::uint8_t raw[sizeof(Value)];
  std::memcpy(raw, &value, sizeof(Value));
  bytes.insert(bytes.end(), raw, raw + sizeof(Value));
}

inline Bytes floats(std::initializer_list<float> values) {
  Bytes bytes;
  for (const float value : values) {
    append(bytes, value);
  }
  return bytes;
}

inline Bytes operator+(Bytes front, const Bytes& back) {
  front.insert(front.end(), back.begin(), back.end());
  return front;
}

/// The values of a frame beside its payload.
struct MavlinkSender {
  int version = 2;
  std::uint8_t system_id = 1;
  std::uint8_t component_id = 1;
  std::uint8_t incompatible_flags = 0;
  bool trims_zeros = true;  ///< for version 2 only
};

inline Bytes mavlink_frame(std::uint32_t id, std::uint8_t seed, Bytes payload,
                           const MavlinkSender& sender = {}) {
  if (sender.version == 2 && sender.trims_zeros) {
    while (payload.size() > 1 && payload.back() == 0) {
      payload.pop_back();
    }
  }
  Bytes frame{static_cast<std::uint8_t>(sender.version == 2 ? 0xFD : 0xFE),
              static_cast<std::uint8_t>(payload.size())};
  if (sender.version == 2) {
    frame = frame + Bytes{sender.incompatible_flags, 0};
  }
  frame = frame + Bytes{7, sender.system_id, sender.component_id, static_cast<std::uint8_t>(id)};
  if (sender.version == 2) {
    frame = frame + Bytes{static_cast<std::uint8_t>(id >> 8U), static_cast<std::uint8_t>(id >> 16U)};
  }
  frame = frame + payload;
  std::uint16_t crc = 0xFFFF;
  for (std::size_t i = 1; i < frame.size(); ++i) {
    crc = mavlink_crc(crc, frame[i]);
  }
  append(frame, mavlink_crc(crc, seed));
  if ((sender.incompatible_flags & 1U) != 0) {
    frame.resize(frame.size() + 13, 0xAB);  // the signature
  }
  return frame;
}

inline Bytes attitude_frame(std::uint32_t time_boot_ms, float roll, float pitch, float yaw,
                            const MavlinkSender& sender = {}) {
  Bytes payload;
  append(payload, time_boot_ms);
  return mavlink_frame(30, 39, payload + floats({roll, pitch, yaw, 0.1F, 0.2F, 0.3F}), sender);
}

inline Bytes position_frame(std::uint32_t time_boot_ms, float x, float y, float z,
                            const MavlinkSender& sender = {}) {
  Bytes payload;
  append(payload, time_boot_ms);
  return mavlink_frame(32, 185, payload + floats({x, y, z, 0, 0, 0}), sender);
}

/// GLOBAL_POSITION_INT of a vehicle without a fix: latitude and longitude are 0.
inline Bytes depth_frame(std::uint32_t time_boot_ms, std::int32_t alt_mm, std::int32_t relative_alt_mm) {
  Bytes payload;
  append(payload, time_boot_ms);
  for (const std::int32_t value : {0, 0, alt_mm, relative_alt_mm, 0, 0}) {
    append(payload, value);
  }
  return mavlink_frame(33, 104, payload);
}

/// A vehicle at rest, heading north.
inline Bytes odometry_frame(std::uint64_t time_usec, float x, float y, float z, std::uint8_t frame_id = 1,
                            const MavlinkSender& sender = {}) {
  Bytes payload;
  append(payload, time_usec);
  payload = payload + floats({x, y, z, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  payload.resize(228);
  return mavlink_frame(331, 91, payload + Bytes{frame_id, 12}, sender);
}

inline Bytes heartbeat_frame(const MavlinkSender& sender = {}) {
  return mavlink_frame(0, 50, {0, 0, 0, 0, 12, 3, 81, 4, 3}, sender);
}

}  // namespace sonard::test
