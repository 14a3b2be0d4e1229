// SPDX-License-Identifier: Apache-2.0
#include "protocol/oculus/codec.hpp"

#include <array>
#include <cassert>
#include <tuple>

#include "protocol/oculus/image_form.hpp"
#include "protocol/oculus/layout.hpp"

namespace sonard::oculus {
namespace {

Header header_of(MessageId id, std::uint16_t version, std::size_t size, const Identity& identity) {
  Header header;
  header.source = identity.device_id;
  header.id = id;
  header.version = version;
  header.payload_size = static_cast<std::uint32_t>(size - header_size);
  header.part_number = identity.part_number;
  return header;
}

Header take_header(ByteReader& reader) {
  Header header;
  read_fields<HeaderLayout>(reader, header);
  if (header.magic != oculus_id) {
    reader.fail_at(0, WireErrorReason::bad_value, "oculusId");
  }
  return header;
}

// The sign of a zero means nothing, but clients print it.
void make_zero_positive(double& value) {
  value += 0.0;
}
template <std::size_t N>
void make_zero_positive(std::array<double, N>& values) {
  for (double& value : values) {
    make_zero_positive(value);
  }
}
template <class Value>
void make_zero_positive(Value&) {}

template <class Message, class Member>
void make_zero_positive(Message& message, const Field<Message, Member>& field) {
  make_zero_positive(message.*field.member);
}
template <class Message, std::size_t Size>
void make_zero_positive(Message&, const Spare<Size>&) {}

/// Writes `message` by `Table`, with 0.0 in place of -0.0.
template <class Table, class Message>
void write_message(ByteWriter& writer, Message message) {
  std::apply([&](const auto&... field) { (make_zero_positive(message, field), ...); }, Table::fields);
  write_fields<Table>(writer, message);
}

void write_fire(ByteWriter& writer, const SimpleFire& fire) {
  write_message<FireLayout>(writer, fire.fire);
  if (fire.extension) {
    write_message<FireExtensionLayout>(writer, *fire.extension);
  }
}

template <class Layout, class Message>
std::vector<std::uint8_t> encode_fixed(MessageId id, const Message& message, const Identity& identity) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  write_fields<HeaderLayout>(writer, header_of(id, 0, Layout::size, identity));
  write_message<Layout>(writer, message);
  return bytes;
}

std::vector<std::uint8_t> encode_text(MessageId id, std::string_view text, const Identity& identity) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  write_fields<HeaderLayout>(writer, header_of(id, 0, header_size + text.size(), identity));
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

/// True if counts, offsets and sizes are consistent with each other and with a message of `size` bytes.
bool fits(const PingResult& ping, std::uint64_t size) {
  const std::size_t fixed_size = ping.fire.extension ? result_v2_size : result_v1_size;
  const std::uint64_t image_size = std::uint64_t{ping.ranges} * row_size(ping);
  return ping.image_size == image_size && ping.message_size == size &&
         std::uint64_t{ping.image_offset} + ping.image_size == size &&
         ping.image_offset >= fixed_size + 2 * std::size_t{ping.beams};
}

}  // namespace

Result<Command, WireError> decode_command(std::span<const std::uint8_t> message) {
  ByteReader reader(message);
  const Header header = take_header(reader);
  Command command{Unknown{header.id}};
  if (header.id == MessageId::simple_fire) {
    SimpleFire fire;
    fire.version = header.version;
    read_fields<FireLayout>(reader, fire.fire);
    if (message.size() >= fire_v2_size) {
      read_fields<FireExtensionLayout>(reader, fire.extension.emplace());
    }
    command = fire;
  } else if (header.id == MessageId::user_config) {
    read_fields<UserConfigLayout>(reader, command.emplace<UserConfig>());
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return command;
}

std::vector<std::uint8_t> encode(const SimpleFire& fire) {
  std::vector<std::uint8_t> bytes;
  ByteWriter writer(bytes);
  write_fields<HeaderLayout>(writer, header_of(MessageId::simple_fire, fire.version,
                                               fire.extension ? fire_v2_size : fire_v1_size, {}));
  write_fire(writer, fire);
  return bytes;
}

std::vector<std::uint8_t> encode(const UserConfig& config) {
  return encode(config, Identity{});
}

std::vector<std::uint8_t> encode(const UserConfig& config, const Identity& identity) {
  return encode_fixed<UserConfigLayout>(MessageId::user_config, config, identity);
}

std::vector<std::uint8_t> encode(const Status& status, const Identity& identity) {
  return encode_fixed<StatusLayout>(MessageId::status, status, identity);
}

std::vector<std::uint8_t> encode_dummy(const Identity& identity) {
  return encode_text(MessageId::dummy, "", identity);
}

std::vector<std::uint8_t> encode_log(std::string_view text, const Identity& identity) {
  return encode_text(MessageId::logs, text, identity);
}

std::vector<std::uint8_t> encode(const PingResult& ping, const Identity& identity) {
  const bool second = ping.fire.extension.has_value();
  PingResult stated = ping;
  stated.beams = static_cast<std::uint16_t>(ping.bearings_cdeg.size());
  stated.image_size = static_cast<std::uint32_t>(ping.image.size());
  stated.message_size = ping.image_offset + stated.image_size;

  std::vector<std::uint8_t> bytes;
  bytes.reserve(stated.message_size);
  ByteWriter writer(bytes);
  write_fields<HeaderLayout>(
      writer, header_of(MessageId::simple_ping_result, ping.fire.version, stated.message_size, identity));
  write_fire(writer, ping.fire);
  if (second) {
    write_message<ResultV2Layout>(writer, stated);
  } else {
    write_message<ResultV1Layout>(writer, stated);
  }
  for (const std::int16_t bearing : ping.bearings_cdeg) {
    write_value(writer, bearing);
  }
  assert(writer.offset() <= ping.image_offset);
  writer.zeros(ping.image_offset - writer.offset());
  writer.bytes(ping.image);
  return bytes;
}

Result<PingResult, WireError> decode_ping_head(std::span<const std::uint8_t> message) {
  ByteReader reader(message);
  const Header header = take_header(reader);
  PingResult ping;
  ping.fire.version = header.version;
  read_fields<FireLayout>(reader, ping.fire.fire);
  if (header.version == 2) {
    read_fields<FireExtensionLayout>(reader, ping.fire.extension.emplace());
    read_fields<ResultV2Layout>(reader, ping);
  } else {
    read_fields<ResultV1Layout>(reader, ping);
  }
  if (header.id != MessageId::simple_ping_result) {
    reader.fail_at(6, WireErrorReason::bad_value, "msgId");
  }
  if (!fits(ping, std::uint64_t{header.payload_size} + header_size)) {
    reader.fail(WireErrorReason::bad_length, "imageSize");
  }
  if (reader.ok()) {
    ping.bearings_cdeg.resize(ping.beams);
  }
  for (std::int16_t& bearing : ping.bearings_cdeg) {
    read_value(reader, "bearings", bearing);
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return ping;
}

Result<PingResult, WireError> decode_ping_result(std::span<const std::uint8_t> message) {
  Result<PingResult, WireError> ping = decode_ping_head(message);
  if (ping && ping->message_size != message.size()) {
    return WireError{WireErrorReason::bad_length, message.size(), "messageSize"};
  }
  if (ping) {
    ping->image = message.subspan(ping->image_offset, ping->image_size);
  }
  return ping;
}

Result<Status, WireError> decode_status(std::span<const std::uint8_t> datagram) {
  ByteReader reader(datagram);
  take_header(reader);
  Status status;
  read_fields<StatusLayout>(reader, status);
  if (datagram.size() != status_size) {
    reader.fail_at(10, WireErrorReason::bad_length, "payloadSize");
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return status;
}

}  // namespace sonard::oculus
