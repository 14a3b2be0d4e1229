// SPDX-License-Identifier: Apache-2.0
// The messages of sonard's MCAP files, as protobuf generates them from protocol/log/sonard_log.proto, which
// says what each field means. They are filled in and read as they are; poses by
// protocol/pose/pose_message.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/log/sonard_log.pb.h"

namespace sonard::log {

/// The encoding of schemas and messages, named as in MCAP's list of well-known encodings.
inline constexpr std::string_view encoding_name = "protobuf";

/// What the MCAP schema of a message holds: its file and all that this imports, imported files first, as a
/// serialised FileDescriptorSet.
std::vector<std::uint8_t> schema_data(const google::protobuf::Descriptor& message);

std::vector<std::uint8_t> encode(const google::protobuf::MessageLite& message);

/// One line on why the numbers of an image do not fit each other; nothing when they do: range_lines * beams
/// pixels and a bearing for each beam.
std::optional<std::string> problem_of(const SonarImage& image);

/// nullopt when `bytes` are no such message.
template <class Message>
std::optional<Message> decode(std::span<const std::uint8_t> bytes) {
  Message message;
  if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return std::nullopt;
  }
  return message;
}

}  // namespace sonard::log
