// SPDX-License-Identifier: Apache-2.0
// Packets <-> messages of a Sonar 3D-15. Source: protocol/sonar3d15/README.md 2. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/sonar3d15/packet.hpp"
#include "protocol/sonar3d15/sonar3d15.pb.h"

namespace sonard::sonar3d15 {

using ::waterlinked::sonar::protocol::BitmapImageGreyscale8;
using ::waterlinked::sonar::protocol::Header;
using ::waterlinked::sonar::protocol::ImuBatch;
using ::waterlinked::sonar::protocol::RangeImage;

/// A message of another type, which clients must skip.
struct Unknown {
  std::string type;  ///< its full name
};

using Message = std::variant<RangeImage, BitmapImageGreyscale8, ImuBatch, Unknown>;

/// A packet of this kind with a message: any alternative of Message other than Unknown.
std::vector<std::uint8_t> encode(const google::protobuf::Message& message, PacketId id);

/// Decodes a whole packet. An image has as many pixels as its width and height say.
Result<Message, WireError> decode(std::span<const std::uint8_t> packet);

}  // namespace sonard::sonar3d15
