-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the Ping protocol of a Ping1D or Ping2, over UDP or TCP, in both directions. Section numbers
-- refer to protocol/ping1d/README.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this:
--   tshark -X lua_script:sonard_ping1d.lua -r capture.pcapng
-- Packets that begin with a message of these devices alone are found on any port; the preferences of the protocol
-- PING1D_SONAR set ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")

local device = {
  name = "ping1d",
  title = "Ping1D echo sounder",
  tables = tables,
  layouts = dofile(here .. "sonard_ping1d_fields.lua"),
  with_data = { "profile" },
  asked_by_empty = { device_information = true, protocol_version = true },
  least_own_id = 1000,  -- smaller ones are common to all devices of the Ping protocol
}
for id, name in pairs(device.layouts.reports) do
  if id >= device.least_own_id then
    device.asked_by_empty[name] = true  -- 3.1
  end
end
assert(loadfile(here .. "sonard_ping.lua"))(device)
local details = device.details
details.continuous_start = device.add_about
details.continuous_stop = device.add_about

local function distance_text(tvb)
  return string.format("%.3f m, %d %%", tvb(8, 4):le_uint() / 1000, tvb(12, 1):uint())
end
details.distance_simple = distance_text
details.distance = distance_text

function details.profile(tvb, tree)
  return string.format("%s, %d points", distance_text(tvb), device.add_data(tvb, tree, device.layouts.messages.profile))
end

device.listen(device.proto, { udp = "6676,9090" }, "Ports of heads, and of bridges of vehicles")
