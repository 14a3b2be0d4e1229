// SPDX-License-Identifier: Apache-2.0
#include "clients/wireshark/ping_fields.hpp"
#include "protocol/ping360/layout.hpp"

namespace sonard::wireshark {

std::string ping360_field_tables() {
  return ping_field_tables<ping360::Layout, ping360::Command, ping360::Report>("ping360");
}

}  // namespace sonard::wireshark
