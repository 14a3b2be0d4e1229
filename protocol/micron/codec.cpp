// SPDX-License-Identifier: Apache-2.0
#include "protocol/micron/codec.hpp"

#include <algorithm>
#include <tuple>
#include <type_traits>

#include "protocol/common/byte_reader.hpp"
#include "protocol/common/byte_writer.hpp"
#include "protocol/micron/layout.hpp"

namespace sonard::micron {

bool HeadData::operator==(const HeadData& other) const {
  const auto rest = [](const HeadData& line) {
    return std::tie(line.device_type, line.status, line.sweep, line.control, line.range_scale, line.tx_word,
                    line.gain, line.slope, line.ad_span, line.ad_low, line.heading_offset, line.ad_interval,
                    line.left_limit, line.right_limit, line.step, line.bearing);
  };
  return rest(*this) == rest(other) && std::ranges::equal(data, other.data);
}

namespace {

static_assert(layout_is_contiguous<Layout<SendData>>(13) && layout_is_contiguous<Layout<HeadCommand>>(14) &&
              layout_is_contiguous<Layout<GainBlock>>(0) && layout_is_contiguous<Layout<VersionData>>(13) &&
              layout_is_contiguous<Layout<Alive>>(13) && layout_is_contiguous<Layout<HeadData>>(15) &&
              layout_is_contiguous<Layout<PortSettings>>(0) && layout_is_contiguous<Layout<BBUserData>>(13) &&
              layout_is_contiguous<Layout<FpgaVersionData>>(13) &&
              layout_is_contiguous<Layout<FpgaCalData>>(13));

/// First byte of the data of a head command (5.3).
enum class Form : std::uint8_t { full = 0x01, full_with_gain_block = 0x1D, gain = 0x1E, reverse = 0x0F };

constexpr std::size_t form_offset = 13;
constexpr std::size_t line_count_excess = 31;  // total count less data count
constexpr std::size_t older_user_blocks_end = 174;
constexpr std::size_t dst_duplex_offset = 146;
constexpr std::size_t dst_user_blocks_end = 263;

template <class Message>
concept HasLayout = requires {
  Layout<Message>::size;
};

// ---- Bodies: by the layout table; overloads for messages that no table can describe

template <class Message>
void read_body(ByteReader& reader, Message& message) {
  if constexpr (HasLayout<Message>) {
    read_fields<Layout<Message>>(reader, message);
  }
}

template <class Message>
void write_body(ByteWriter& writer, const Message& message) {
  if constexpr (HasLayout<Message>) {
    write_fields<Layout<Message>>(writer, message);
  }
}

void write_body(ByteWriter& writer, const HeadCommand& message) {
  const bool longer = message.gain_block.has_value();
  writer.u8(static_cast<std::uint8_t>(longer ? Form::full_with_gain_block : Form::full));
  write_fields<Layout<HeadCommand>>(writer, message);
  if (longer) {
    write_fields<Layout<GainBlock>>(writer, *message.gain_block);
  }
}

void write_body(ByteWriter& writer, const GainCommand& message) {
  writer.u8(static_cast<std::uint8_t>(Form::gain));
  write_fields<Layout<GainBlock>>(writer, message.values);
}

void write_body(ByteWriter& writer, const ReverseCommand&) {
  writer.u8(static_cast<std::uint8_t>(Form::reverse));
}

/// The counts must match the data: otherwise the line was cut or is noise.
void read_body(ByteReader& reader, HeadData& message) {
  const std::size_t total = reader.u16le("total_count");
  read_fields<Layout<HeadData>>(reader, message);
  const std::size_t count = reader.u16le("data_count");
  message.data = reader.bytes(count, "data");
  if (total != count + line_count_excess) {
    reader.fail_at(frame_header_size, WireErrorReason::bad_length, "total_count");
  }
}

void write_body(ByteWriter& writer, const HeadData& message) {
  const auto data = message.data.first(std::min<std::size_t>(message.data.size(), max_bins));
  writer.u16le(static_cast<std::uint16_t>(data.size() + line_count_excess));
  write_fields<Layout<HeadData>>(writer, message);
  writer.u16le(static_cast<std::uint16_t>(data.size()));
  writer.bytes(data);
}

void read_body(ByteReader& reader, BBUserData& message) {
  const std::size_t end = reader.offset() + reader.remaining();
  if (end != older_user_blocks_end && end != dst_user_blocks_end) {
    reader.fail(WireErrorReason::bad_length, "user_blocks");
    return;
  }
  read_fields<Layout<BBUserData>>(reader, message);
  message.dst_half_duplex.reset();
  if (end == dst_user_blocks_end) {
    reader.skip(dst_duplex_offset - reader.offset(), "spare");
    message.dst_half_duplex = reader.u8("dst_half_duplex");
  }
}

void write_body(ByteWriter& writer, const BBUserData& message) {
  const auto pad_to = [&](std::size_t frame_offset) {
    writer.zeros(frame_offset - frame_header_size - writer.offset());
  };
  write_fields<Layout<BBUserData>>(writer, message);
  if (message.dst_half_duplex) {
    pad_to(dst_duplex_offset);
    writer.u8(*message.dst_half_duplex);
  }
  pad_to(message.dst_half_duplex ? dst_user_blocks_end : older_user_blocks_end);
}

void read_body(ByteReader& reader, AuxData& message) {
  const auto data = reader.bytes(reader.u16le("data_count"), "data");
  message.data.assign(data.begin(), data.end());
}

void write_body(ByteWriter& writer, const AuxData& message) {
  const auto data = std::span{message.data}.first(std::min<std::size_t>(message.data.size(), max_bins));
  writer.u16le(static_cast<std::uint16_t>(data.size()));
  writer.bytes(data);
}

// ---- Dispatch over the variants

/// Reads one of the three messages that share the type of head commands.
Command read_head_command(ByteReader& reader) {
  switch (static_cast<Form>(reader.u8("form"))) {
    case Form::full: {
      HeadCommand command;
      read_fields<Layout<HeadCommand>>(reader, command);
      return command;
    }
    case Form::full_with_gain_block: {
      HeadCommand command;
      read_fields<Layout<HeadCommand>>(reader, command);
      if (reader.remaining() >= Layout<GainBlock>::size) {
        read_fields<Layout<GainBlock>>(reader, command.gain_block.emplace());
      }
      return command;
    }
    case Form::gain: {
      GainCommand command;
      read_fields<Layout<GainBlock>>(reader, command.values);
      return command;
    }
    case Form::reverse:
      return ReverseCommand{};
  }
  reader.fail_at(form_offset, WireErrorReason::bad_value, "form");
  return Unknown{};
}

/// Turns `variant` into a Message and reads it, if `type` is its type.
template <class Message, class Variant>
void read_if_announced(ByteReader& reader, std::uint8_t type, Variant& variant) {
  if constexpr (std::is_same_v<Message, HeadCommand>) {
    if (type == static_cast<std::uint8_t>(Message::type)) {
      variant = read_head_command(reader);
    }
  } else if constexpr (!std::is_same_v<Message, Unknown> && !std::is_same_v<Message, GainCommand> &&
                       !std::is_same_v<Message, ReverseCommand>) {
    if (type == static_cast<std::uint8_t>(Message::type)) {
      read_body(reader, variant.template emplace<Message>());
    }
  }
}

template <class... Messages>
Result<std::variant<Messages...>, WireError> decode(std::span<const std::uint8_t> frame,
                                                    const std::variant<Messages...>*) {
  if (frame.size() < min_frame_size) {
    return WireError{WireErrorReason::truncated, frame.size(), "header"};
  }
  const std::uint8_t type = frame_header(frame).type;
  ByteReader reader{frame.first(frame.size() - 1)};
  reader.skip(frame_header_size, "header");
  std::variant<Messages...> variant{Unknown{type}};
  (read_if_announced<Messages>(reader, type, variant), ...);
  if (!reader.ok()) {
    return *reader.error();
  }
  return variant;
}

template <class Variant>
std::vector<std::uint8_t> body_of(const Variant& variant) {
  std::vector<std::uint8_t> body;
  ByteWriter writer{body};
  std::visit([&](const auto& message) { write_body(writer, message); }, variant);
  return body;
}

template <class Variant>
std::uint8_t type_of_variant(const Variant& variant) {
  return std::visit([](const auto& message) { return static_cast<std::uint8_t>(message.type); }, variant);
}

}  // namespace

Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame) {
  return decode(frame, static_cast<const Command*>(nullptr));
}

Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame) {
  return decode(frame, static_cast<const Report*>(nullptr));
}

std::vector<std::uint8_t> encode(const Command& command, std::uint8_t head_node) {
  return frame_to_head(head_node, type_of(command), body_of(command));
}

std::vector<std::uint8_t> encode(const Report& report, std::uint8_t head_node) {
  return frame_from_head(head_node, type_of(report), body_of(report));
}

std::uint8_t type_of(const Command& command) {
  return type_of_variant(command);
}
std::uint8_t type_of(const Report& report) {
  return type_of_variant(report);
}

}  // namespace sonard::micron
