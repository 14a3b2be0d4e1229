// SPDX-License-Identifier: Apache-2.0
// The messages in tests/data/DEVICE/messages.json, which tests of codecs, dissectors, clients and devices
// share (tests/data/messages.md).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sonard::testing {

using Bytes = std::vector<std::uint8_t>;

/// The bytes of one message. @throws std::runtime_error if the device has no message with this name
Bytes message_bytes(const std::string& device, const std::string& name);

/// Names of all messages of a device, sorted.
std::vector<std::string> message_names(const std::string& device);

}  // namespace sonard::testing
