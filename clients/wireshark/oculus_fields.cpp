// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "clients/wireshark/lua_tables.hpp"
#include "protocol/oculus/layout.hpp"

namespace sonard::wireshark {
namespace {

using oculus::MessageId;

using Names = std::pair<MessageId, std::string_view>;
constexpr std::array commands{Names{MessageId::simple_fire, "simple_fire"},
                              Names{MessageId::user_config, "user_config"}};
constexpr std::array reports{Names{MessageId::status, "status"},
                             Names{MessageId::simple_ping_result, "simple_ping_result"},
                             Names{MessageId::user_config, "user_config"}, Names{MessageId::logs, "logs"},
                             Names{MessageId::dummy, "dummy"}};

template <class Messages>
void append_types(std::string& lua, const Messages& messages) {
  for (const auto& [id, name] : messages) {
    append_type(lua, static_cast<unsigned>(id), name);
  }
}

}  // namespace

std::string oculus_field_tables() {
  std::string lua = table_head("oculus") + "  commands = {\n";
  append_types(lua, commands);
  lua += "  },\n  reports = {\n";
  append_types(lua, reports);
  lua += "  },\n  messages = {\n";
  append_message<oculus::HeaderLayout>(lua, "header");
  append_message<oculus::FireLayout>(lua, "fire");
  append_message<oculus::FireExtensionLayout>(lua, "fire_extension");
  append_message<oculus::ResultV1Layout>(lua, "result_v1");
  append_message<oculus::ResultV2Layout>(lua, "result_v2");
  append_message<oculus::UserConfigLayout>(lua, "user_config");
  append_message<oculus::StatusLayout>(lua, "status");
  return lua + "  },\n}\n";
}

}  // namespace sonard::wireshark
