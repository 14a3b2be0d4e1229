// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/codec.hpp"

#include <algorithm>
#include <string>
#include <tuple>
#include <type_traits>

#include "protocol/ping360/layout.hpp"

namespace sonard::ping360 {

bool DeviceData::operator==(const DeviceData& other) const {
  const auto rest = [](const DeviceData& it) {
    return std::tie(it.mode, it.gain_setting, it.angle, it.transmit_duration_us, it.sample_period,
                    it.transmit_frequency_khz, it.number_of_samples);
  };
  return rest(*this) == rest(other) && std::ranges::equal(data, other.data);
}

bool AutoDeviceData::operator==(const AutoDeviceData& other) const {
  const auto rest = [](const AutoDeviceData& it) {
    return std::tie(it.mode, it.gain_setting, it.angle, it.transmit_duration_us, it.sample_period,
                    it.transmit_frequency_khz, it.start_angle, it.stop_angle, it.num_steps, it.delay_ms,
                    it.number_of_samples);
  };
  return rest(*this) == rest(other) && std::ranges::equal(data, other.data);
}

namespace {

template <class... Messages>
consteval bool are_contiguous() {
  return (layout_is_contiguous<Layout<Messages>>(frame_header_size) && ...);
}
static_assert(are_contiguous<GeneralRequest, SetCommonDeviceId, SetDeviceId, Reset, Transducer, AutoTransmit,
                             Ack, Nack, DeviceInformation, ProtocolVersion, DeviceData, AutoDeviceData>());

template <class Message>
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

template <class Message>
void read_body(ByteReader& reader, Message& message) {
  if constexpr (HasLayout<Message>) {
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

template <class Message>
void write_body(ByteWriter& writer, const Message& message) {
  if constexpr (HasLayout<Message>) {
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
template <class Message, class Variant>
void read_if_announced(ByteReader& reader, std::uint16_t id, Variant& variant) {
  if constexpr (!std::is_same_v<Message, Unknown>) {
    if (id == static_cast<std::uint16_t>(Message::id)) {
      read_body(reader, variant.template emplace<Message>());
    }
  }
}

template <class... Messages>
std::variant<Messages...> read_message(ByteReader& reader, std::uint16_t id,
                                       const std::variant<Messages...>*) {
  std::variant<Messages...> variant{Unknown{id}};
  (read_if_announced<Messages>(reader, id, variant), ...);
  return variant;
}

/// True if an empty message with this id is a request for that message (2.1).
bool is_older_request(std::uint16_t id) {
  return id == static_cast<std::uint16_t>(MessageId::device_information) ||
         id == static_cast<std::uint16_t>(MessageId::protocol_version) ||
         id == static_cast<std::uint16_t>(MessageId::device_data);
}

template <class Variant>
Result<Variant, WireError> decode(std::span<const std::uint8_t> frame, bool insists_on_end) {
  if (frame.size() < frame_overhead) {
    return WireError{WireErrorReason::truncated, frame.size(), "header"};
  }
  const std::uint16_t id = frame_header(frame).message_id;
  ByteReader reader{frame.first(frame.size() - checksum_size)};
  reader.skip(frame_header_size, "header");
  const Variant variant = read_message(reader, id, static_cast<const Variant*>(nullptr));
  if (insists_on_end && reader.remaining() > 0 && !std::holds_alternative<Unknown>(variant)) {
    reader.fail(WireErrorReason::bad_length, "payload");
  }
  if (!reader.ok()) {
    return *reader.error();
  }
  return variant;
}

template <class Variant>
std::vector<std::uint8_t> encode_message(const Variant& variant, std::uint8_t source,
                                         std::uint8_t destination) {
  std::vector<std::uint8_t> body;
  ByteWriter writer{body};
  std::visit([&](const auto& message) { write_body(writer, message); }, variant);
  return make_frame(id_of(variant), source, destination, body);
}

template <class Variant>
std::uint16_t id_of_variant(const Variant& variant) {
  return std::visit([](const auto& message) { return static_cast<std::uint16_t>(message.id); }, variant);
}

}  // namespace

Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame) {
  if (frame.size() == frame_overhead && is_older_request(frame_header(frame).message_id)) {
    return Command{GeneralRequest{frame_header(frame).message_id}};
  }
  return decode<Command>(frame, true);
}

Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame) {
  return decode<Report>(frame, false);
}

std::vector<std::uint8_t> encode(const Command& command, std::uint8_t source, std::uint8_t destination) {
  return encode_message(command, source, destination);
}

std::vector<std::uint8_t> encode(const Report& report, std::uint8_t source, std::uint8_t destination) {
  return encode_message(report, source, destination);
}

std::uint16_t id_of(const Command& command) {
  return id_of_variant(command);
}
std::uint16_t id_of(const Report& report) {
  return id_of_variant(report);
}

}  // namespace sonard::ping360
