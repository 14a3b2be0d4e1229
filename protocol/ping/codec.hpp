// SPDX-License-Identifier: Apache-2.0
// Frames <-> messages of any device of the Ping protocol. A device gives the messages of a direction as a
// std::variant that begins with Unknown, and a template `Layout` with the table of each message that has one.
// After its table a message may have a member `text` (the rest of the payload), or `data` (a u16 count, then
// that many bytes). Source: protocol/ping360/README.md 1, 2. No state; any thread.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <type_traits>
#include <variant>
#include <vector>

#include "protocol/common/layout.hpp"
#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/ping/frame.hpp"
#include "protocol/ping/messages.hpp"

namespace sonard::ping {

template <template <class> class Layout, class Message>
concept HasLayout = requires {
  Layout<Message>::size;
};
template <class Message>
concept HasText = requires(Message message) {
  message.text;
};
template <class Message>
concept HasData = requires(Message message) {
  message.data;
};

// ---- Bodies: by the layout table, then text or data

template <template <class> class Layout, class Message>
void read_body(ByteReader& reader, Message& message) {
  if constexpr (HasLayout<Layout, Message>) {
    read_fields<Layout<Message>>(reader, message);
  }
  if constexpr (HasText<Message>) {
    const auto text = reader.bytes(reader.remaining(), "text");
    message.text.assign(text.begin(), text.end());
  }
  if constexpr (HasData<Message>) {
    message.data = reader.bytes(reader.u16le("data_length"), "data");
  }
}

template <template <class> class Layout, class Message>
void write_body(ByteWriter& writer, const Message& message) {
  if constexpr (HasLayout<Layout, Message>) {
    write_fields<Layout<Message>>(writer, message);
  }
  if constexpr (HasText<Message>) {
    const auto length = std::min(message.text.size(), max_payload_size - writer.offset());
    for (const char letter : message.text.substr(0, length)) {
      writer.u8(static_cast<std::uint8_t>(letter));
    }
  }
  if constexpr (HasData<Message>) {
    const auto data = message.data.first(
        std::min(message.data.size(), max_payload_size - writer.offset() - sizeof(std::uint16_t)));
    writer.u16le(static_cast<std::uint16_t>(data.size()));
    writer.bytes(data);
  }
}

// ---- Dispatch over the variants

/// Turns `variant` into a Message and reads it, if `id` is its id.
template <template <class> class Layout, class Message, class Variant>
void read_if_announced(ByteReader& reader, std::uint16_t id, Variant& variant) {
  if constexpr (!std::is_same_v<Message, Unknown>) {
    if (id == static_cast<std::uint16_t>(Message::id)) {
      read_body<Layout>(reader, variant.template emplace<Message>());
    }
  }
}

template <template <class> class Layout, class... Messages>
std::variant<Messages...> read_message(ByteReader& reader, std::uint16_t id,
                                       const std::variant<Messages...>*) {
  std::variant<Messages...> variant{Unknown{id}};
  (read_if_announced<Layout, Messages>(reader, id, variant), ...);
  return variant;
}

// ---- Frames

/// The id of the message in the variant, also for Unknown.
template <class Variant>
std::uint16_t id_in(const Variant& variant) {
  return std::visit([](const auto& message) { return static_cast<std::uint16_t>(message.id); }, variant);
}

/// Decodes a frame, as returned by FrameBuffer. Returns Unknown for an id that is not in the variant, and an
/// error if the payload is too short.
/// @param frame members `data` view it
/// @param insists_on_end an error if the payload is longer than its message; false: ignores the rest
template <template <class> class Layout, class Variant>
Result<Variant, WireError> decode_frame(std::span<const std::uint8_t> frame, bool insists_on_end) {
  if (frame.size() < frame_overhead) {
    return WireError{WireErrorReason::truncated, frame.size(), "header"};
  }
  const std::uint16_t id = frame_header(frame).message_id;
  ByteReader reader{frame.first(frame.size() - checksum_size)};
  reader.skip(frame_header_size, "header");
  const Variant variant = read_message<Layout>(reader, id, static_cast<const Variant*>(nullptr));
  if (insists_on_end && reader.remaining() > 0 && !std::holds_alternative<Unknown>(variant)) {
    reader.fail(WireErrorReason::bad_length, "payload");
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return variant;
}

/// Encodes one frame. Cuts text or data that would make the payload longer than max_payload_size.
template <template <class> class Layout, class Variant>
std::vector<std::uint8_t> encode_frame(const Variant& variant, std::uint8_t source,
                                       std::uint8_t destination) {
  std::vector<std::uint8_t> body;
  ByteWriter writer{body};
  std::visit([&](const auto& message) { write_body<Layout>(writer, message); }, variant);
  return make_frame(id_in(variant), source, destination, body);
}

}  // namespace sonard::ping
