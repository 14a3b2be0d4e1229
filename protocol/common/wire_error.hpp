// SPDX-License-Identifier: Apache-2.0
// Why bytes from a peer were rejected. Cheap to make; enough for a log line or a metric label.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sonard {

enum class WireErrorReason : std::uint8_t {
  truncated,   ///< the message ends before the field does
  bad_length,  ///< a length in the message, or the length of the datagram itself, fits no message
  bad_value,   ///< a field has a value that makes the rest of the message undecodable
};

/// A value, never an exception, because peers can send anything.
struct WireError {
  WireErrorReason reason = WireErrorReason::truncated;
  std::size_t offset = 0;  ///< of the field, in bytes from the start of the datagram or frame
  std::string_view field;  ///< name of the field as in the layout tables; always a string literal

  bool operator==(const WireError&) const = default;
};

/// "truncated", "bad_length", "bad_value".
std::string_view to_string(WireErrorReason reason);
/// One line without a line break, for example "truncated: field end_range at byte 22".
std::string to_string(const WireError& error);

}  // namespace sonard
