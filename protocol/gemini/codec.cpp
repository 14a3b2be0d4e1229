// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/codec.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <variant>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"
#include "protocol/gemini/layout.hpp"

namespace sonard::gemini {
namespace {

template <class... Messages>
consteval bool layouts_are_contiguous(const std::variant<Messages...>*) {
  return ([] {
    if constexpr (HasLayout<Messages>) {
      return layout_is_contiguous<Layout<Messages>>(header_size);
    } else {
      return true;
    }
  }() && ...);
}
static_assert(layouts_are_contiguous(static_cast<const Command*>(nullptr)));
static_assert(layouts_are_contiguous(static_cast<const Report*>(nullptr)));

constexpr std::size_t info_block_filler = 128;
constexpr std::size_t serial_block_size = 8;
constexpr std::size_t serial_time_size = 7;
constexpr std::size_t max_serial_bytes = 255;
constexpr std::size_t mdio_script_offset = 10;
constexpr std::size_t max_mdio_words = (max_datagram_size - mdio_script_offset) / 2;

// ---- Header

struct TypedHeader {
  std::uint8_t type = 0;
  Header header;
};

TypedHeader read_header(ByteReader& reader) {
  TypedHeader typed;
  typed.type = reader.u8("type");
  typed.header.version = reader.u8("version");
  typed.header.sonar_id = reader.u16le("sonar_id");
  typed.header.packet_latency = reader.u16le("packet_latency");
  typed.header.destination = reader.u8("destination");
  typed.header.source = reader.u8("source");
  return typed;
}

void write_header(ByteWriter& writer, std::uint8_t type, const Header& header) {
  writer.u8(type);
  writer.u8(header.version);
  writer.u16le(header.sonar_id);
  writer.u16le(header.packet_latency);
  writer.u8(header.destination);
  writer.u8(header.source);
}

// ---- Bodies: by the layout table; overloads for messages that no table can describe

template <HasLayout Message>
void read_body(ByteReader& reader, Message& message) {
  read_fields<Layout<Message>>(reader, message);
}

template <HasLayout Message>
void write_body(ByteWriter& writer, const Message& message) {
  write_fields<Layout<Message>>(writer, message);
}

void read_body(ByteReader& reader, InfoBlockWrite& message) {
  const std::uint32_t bank = reader.u32le("bank");
  message.flags = reader.u16le("flags");
  reader.skip(2, "spare");
  switch (bank) {
    case 0: {
      auto& block = message.block.emplace<IdentityBlock>();
      block.sonar_id = reader.u32le("sonar_id");
      block.transducer = reader.u32le("transducer");
      reader.skip(4, "spare");
      return;
    }
    case 1: {
      auto& block = message.block.emplace<VelocimeterBlock>();
      block.m_coefficient = reader.u32le("m_coefficient");
      block.c_coefficient = static_cast<std::int32_t>(reader.u32le("c_coefficient"));
      reader.skip(info_block_filler, "filler");
      return;
    }
    case 2: {
      auto& block = message.block.emplace<AddressBlock>();
      block.alternate_ip = reader.u32le("alternate_ip");
      block.subnet_mask = reader.u32le("subnet_mask");
      reader.skip(info_block_filler, "filler");
      return;
    }
    default:
      reader.fail_at(header_size, WireErrorReason::bad_value, "bank");
  }
}

void write_block(ByteWriter& writer, const IdentityBlock& block) {
  writer.u32le(block.sonar_id);
  writer.u32le(block.transducer);
  writer.zeros(4);
}

void write_block(ByteWriter& writer, const VelocimeterBlock& block) {
  writer.u32le(block.m_coefficient);
  writer.u32le(static_cast<std::uint32_t>(block.c_coefficient));
  writer.zeros(info_block_filler);
}

void write_block(ByteWriter& writer, const AddressBlock& block) {
  writer.u32le(block.alternate_ip);
  writer.u32le(block.subnet_mask);
  writer.zeros(info_block_filler);
}

void write_body(ByteWriter& writer, const InfoBlockWrite& message) {
  writer.u32le(static_cast<std::uint32_t>(message.block.index()));
  writer.u16le(message.flags);
  writer.zeros(2);
  std::visit([&](const auto& block) { write_block(writer, block); }, message.block);
}

void read_body(ByteReader& reader, SerialTransmit& message) {
  const std::size_t count = reader.u8("length");
  const auto data = reader.bytes(count, "data");
  message.data.assign(data.begin(), data.end());
}

void write_body(ByteWriter& writer, const SerialTransmit& message) {
  const auto data = std::span{message.data}.first(std::min(message.data.size(), max_serial_bytes));
  writer.u8(static_cast<std::uint8_t>(data.size()));
  writer.bytes(data);
}

/// The length field counts bytes: its own two and the words.
void read_body(ByteReader& reader, MdioCommands& message) {
  const std::size_t length = reader.u16le("length");
  if (length < 2 || length % 2 != 0) {
    reader.fail_at(header_size, WireErrorReason::bad_length, "length");
    return;
  }
  ByteReader script{reader.bytes(length - 2, "words")};
  message.words.reserve(script.remaining() / 2);
  while (script.remaining() > 0) {
    message.words.push_back(script.u16le("words"));
  }
}

void write_body(ByteWriter& writer, const MdioCommands& message) {
  const auto words = std::span{message.words}.first(std::min(message.words.size(), max_mdio_words));
  writer.u16le(static_cast<std::uint16_t>(2 + 2 * words.size()));
  for (const std::uint16_t word : words) {
    writer.u16le(word);
  }
}

void read_body(ByteReader& reader, PingLine& message) {
  read_fields<Layout<PingLine>>(reader, message);
  message.data = reader.bytes(4 * message.word_count(), "data");
}

void write_body(ByteWriter& writer, const PingLine& message) {
  write_fields<Layout<PingLine>>(writer, message);
  writer.bytes(message.data);
}

void read_body(ByteReader& reader, SerialData& message) {
  if (reader.remaining() % serial_block_size != 0) {
    reader.fail(WireErrorReason::bad_length, "bytes");
    return;
  }
  message.bytes.reserve(reader.remaining() / serial_block_size);
  while (reader.remaining() > 0) {
    const std::uint64_t time_us = reader.little_endian(serial_time_size, "time_us");
    message.bytes.push_back({time_us, reader.u8("value")});
  }
}

void write_body(ByteWriter& writer, const SerialData& message) {
  for (const SerialByte& byte : message.bytes) {
    writer.little_endian(byte.time_us, serial_time_size);
    writer.u8(byte.value);
  }
}

// ---- Dispatch over the variants

/// Turns `variant` into a Message and reads it, if `typed` has its type.
template <class Message, class Variant>
void read_if_announced(ByteReader& reader, const TypedHeader& typed, Variant& variant) {
  if constexpr (!std::is_same_v<Message, Unknown>) {
    if (typed.type == static_cast<std::uint8_t>(Message::type)) {
      auto& message = variant.template emplace<Message>();
      message.header = typed.header;
      read_body(reader, message);
    }
  }
}

template <class... Messages>
Result<std::variant<Messages...>, WireError> decode(std::span<const std::uint8_t> datagram,
                                                    const std::variant<Messages...>*) {
  ByteReader reader{datagram};
  const TypedHeader typed = read_header(reader);
  std::variant<Messages...> variant{Unknown{typed.header, typed.type}};
  if (reader.ok()) {
    (read_if_announced<Messages>(reader, typed, variant), ...);
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return variant;
}

template <class Variant>
void encode_variant(const Variant& variant, std::vector<std::uint8_t>& out) {
  ByteWriter writer{out};
  std::visit(
      [&]<class Message>(const Message& message) {
        if constexpr (std::is_same_v<Message, Unknown>) {
          write_header(writer, message.type, message.header);
        } else {
          write_header(writer, static_cast<std::uint8_t>(Message::type), message.header);
          write_body(writer, message);
        }
      },
      variant);
}

template <class Variant>
std::uint8_t type_of_variant(const Variant& variant) {
  return std::visit([](const auto& message) { return static_cast<std::uint8_t>(message.type); }, variant);
}

}  // namespace

Result<Header, WireError> decode_header(std::span<const std::uint8_t> datagram) {
  ByteReader reader{datagram};
  const TypedHeader typed = read_header(reader);
  if (!reader.ok()) {
    return *reader.error();
  }
  return typed.header;
}

Result<Command, WireError> decode_command(std::span<const std::uint8_t> datagram) {
  return decode(datagram, static_cast<const Command*>(nullptr));
}

Result<Report, WireError> decode_report(std::span<const std::uint8_t> datagram) {
  return decode(datagram, static_cast<const Report*>(nullptr));
}

void encode(const Command& command, std::vector<std::uint8_t>& out) {
  encode_variant(command, out);
}
void encode(const Report& report, std::vector<std::uint8_t>& out) {
  encode_variant(report, out);
}

std::vector<std::uint8_t> encode(const Command& command) {
  std::vector<std::uint8_t> bytes;
  encode(command, bytes);
  return bytes;
}

std::vector<std::uint8_t> encode(const Report& report) {
  std::vector<std::uint8_t> bytes;
  encode(report, bytes);
  return bytes;
}

const Header& header_of(const Command& command) {
  return std::visit([](const auto& message) -> const Header& { return message.header; }, command);
}

const Header& header_of(const Report& report) {
  return std::visit([](const auto& message) -> const Header& { return message.header; }, report);
}

std::uint8_t type_of(const Command& command) {
  return type_of_variant(command);
}
std::uint8_t type_of(const Report& report) {
  return type_of_variant(report);
}

}  // namespace sonard::gemini
