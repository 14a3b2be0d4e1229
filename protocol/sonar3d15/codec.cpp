// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/codec.hpp"

#include "protocol/common/quiet_protobuf.hpp"

namespace sonard::sonar3d15 {
namespace {

using ::waterlinked::sonar::protocol::Packet;

bool is_whole(const RangeImage& image) {
  return std::uint64_t{image.width()} * image.height() ==
         static_cast<std::uint64_t>(image.image_pixel_data_size());
}
bool is_whole(const BitmapImageGreyscale8& image) {
  return std::uint64_t{image.width()} * image.height() == image.image_pixel_data().size();
}
bool is_whole(const ImuBatch& batch) {
  const auto numbers = 3 * std::uint64_t{batch.samples()};
  return static_cast<std::uint64_t>(batch.timestamps_size()) == batch.samples() &&
         static_cast<std::uint64_t>(batch.specific_force_size()) == numbers &&
         static_cast<std::uint64_t>(batch.rate_of_turn_size()) == numbers;
}

template <class Known>
Result<Message, WireError> read(const google::protobuf::Any& any) {
  Known message;
  if (!any.UnpackTo(&message)) {
    return WireError{WireErrorReason::bad_value, packet_header_size, "value"};
  }
  if (!is_whole(message)) {
    return WireError{WireErrorReason::bad_length, packet_header_size, "image_pixel_data"};
  }
  return Message{std::move(message)};
}

}  // namespace

std::vector<std::uint8_t> encode(const google::protobuf::Message& message, PacketId id) {
  keep_protobuf_quiet();
  Packet packet;
  packet.mutable_msg()->PackFrom(message);
  std::vector<std::uint8_t> bytes(packet.ByteSizeLong());
  packet.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
  return pack(bytes, id);
}

Result<Message, WireError> decode(std::span<const std::uint8_t> packet) {
  const auto bytes = unpack(packet);
  if (!bytes) {
    return bytes.error();
  }
  keep_protobuf_quiet();
  Packet outer;
  if (!outer.ParseFromArray(bytes->data(), static_cast<int>(bytes->size()))) {
    return WireError{WireErrorReason::bad_value, packet_header_size, "payload"};
  }
  const google::protobuf::Any& any = outer.msg();
  if (any.Is<RangeImage>()) {
    return read<RangeImage>(any);
  }
  if (any.Is<BitmapImageGreyscale8>()) {
    return read<BitmapImageGreyscale8>(any);
  }
  if (any.Is<ImuBatch>()) {
    return read<ImuBatch>(any);
  }
  return Message{Unknown{any.type_url().substr(any.type_url().rfind('/') + 1)}};
}

}  // namespace sonard::sonar3d15
