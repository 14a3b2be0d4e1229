// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/dvl_a50/layout.hpp"

namespace sonard::wireshark {

std::string dvl_a50_field_tables() {
  std::string lua = table_head("dvl_a50") + "  messages = {\n";
  append_message<dvl_a50::Pd4Layout>(lua, "pd4");
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
