// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/packet.hpp"

#include <snappy.h>
#include <zlib.h>

#include <string>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"
#include "protocol/sonar3d15/layout.hpp"

namespace sonard::sonar3d15 {
namespace {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// A longer message would not fit a packet of most_packet_size, even if Snappy halves it.
constexpr std::size_t most_message_size = 4 * most_packet_size;

std::uint32_t checksum(ByteView bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

Bytes compressed(ByteView message) {
  std::string block;
  snappy::Compress(reinterpret_cast<const char*>(message.data()), message.size(), &block);
  return {block.begin(), block.end()};
}

}  // namespace

Bytes pack(ByteView message, PacketId id) {
  const Bytes block = id == PacketId::rip2 ? compressed(message) : Bytes{};
  const ByteView payload = id == PacketId::rip2 ? ByteView{block} : message;
  const std::size_t size = packet_header_size + payload.size() + checksum_size;
  Bytes packet;
  packet.reserve(size);
  ByteWriter writer(packet);
  write_fields<PacketLayout>(writer, PacketHeader{id, static_cast<std::uint32_t>(size)});
  writer.bytes(payload);
  writer.u32le(checksum(packet));
  return packet;
}

Result<ByteView, WireError> front_packet(ByteView bytes) {
  ByteReader reader(bytes);
  PacketHeader header;
  read_fields<PacketLayout>(reader, header);
  if (reader.ok() && header.id != PacketId::rip1 && header.id != PacketId::rip2) {
    return WireError{WireErrorReason::bad_value, 0, "id"};
  }
  if (reader.ok() &&
      (header.length < packet_header_size + checksum_size || header.length > most_packet_size)) {
    return WireError{WireErrorReason::bad_length, 4, "length"};
  }
  reader.skip(header.length - packet_header_size - checksum_size, "payload");
  const std::size_t checked = reader.offset();
  const std::uint32_t stated = reader.u32le("crc");
  if (reader.ok() && stated != checksum(bytes.first(checked))) {
    reader.fail_at(checked, WireErrorReason::bad_value, "crc");
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return bytes.first(header.length);
}

Result<Bytes, WireError> unpack(ByteView packet) {
  const auto front = front_packet(packet);
  if (!front) {
    return front.error();
  }
  if (front->size() != packet.size()) {
    return WireError{WireErrorReason::bad_length, 4, "length"};
  }
  const ByteView payload =
      packet.subspan(packet_header_size, packet.size() - packet_header_size - checksum_size);
  if (packet[3] == '1') {
    return Bytes(payload.begin(), payload.end());
  }
  const auto* const block = reinterpret_cast<const char*>(payload.data());
  std::size_t size = 0;
  if (!snappy::GetUncompressedLength(block, payload.size(), &size) || size > most_message_size) {
    return WireError{WireErrorReason::bad_value, packet_header_size, "payload"};
  }
  Bytes message(size);
  if (!snappy::RawUncompress(block, payload.size(), reinterpret_cast<char*>(message.data()))) {
    return WireError{WireErrorReason::bad_value, packet_header_size, "payload"};
  }
  return message;
}

}  // namespace sonard::sonar3d15
