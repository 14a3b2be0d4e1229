// SPDX-License-Identifier: Apache-2.0
#include "clients/wireshark/ping_fields.hpp"
#include "protocol/ping1d/layout.hpp"

namespace sonard::wireshark {

std::string ping1d_field_tables() {
  return ping_field_tables<ping1d::Layout, ping1d::Command, ping1d::Report>("ping1d");
}

}  // namespace sonard::wireshark
