// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/wire_error.hpp"

namespace sonard {

std::string_view to_string(WireErrorReason reason) {
  switch (reason) {
    case WireErrorReason::truncated:
      return "truncated";
    case WireErrorReason::bad_length:
      return "bad_length";
    case WireErrorReason::bad_value:
      return "bad_value";
  }
  return "unknown";
}

std::string to_string(const WireError& error) {
  std::string text{to_string(error.reason)};
  text += ": field ";
  text += error.field;
  text += " at byte ";
  text += std::to_string(error.offset);
  return text;
}

}  // namespace sonard
