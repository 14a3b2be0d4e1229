// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/sonar3d15/layout.hpp"

namespace sonard::wireshark {

std::string sonar3d15_field_tables() {
  std::string lua = table_head("sonar3d15") + "  reports = {\n";
  append_type(lua, static_cast<unsigned>(sonar3d15::PacketId::rip1), "RIP1");
  append_type(lua, static_cast<unsigned>(sonar3d15::PacketId::rip2), "RIP2");
  lua += "  },\n  messages = {\n";
  append_message<sonar3d15::PacketLayout>(lua, "packet");
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
