-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the Ping protocol of a Ping360, over UDP or TCP, in both directions, and for the text
-- messages of its discovery. Section numbers below refer to protocol/ping360/README.md. Put all sonard_*.lua files into
-- the folder for personal Lua plugins, or load this one:
--   tshark -X lua_script:sonard_ping360.lua -r capture.pcapng
-- Streams and datagrams that begin with a frame are found on any port. The preferences of the protocols PING360_SONAR
-- and PING360_DISCOVERY set ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")

local device = {
  name = "ping360",
  title = "Ping360 scanning sonar",
  tables = tables,
  layouts = dofile(here .. "sonard_ping360_fields.lua"),
  with_data = { "device_data", "auto_device_data" },
  asked_by_empty = { device_information = true, protocol_version = true, device_data = true },
  least_own_id = 0,
  extra = {
    bearing = ProtoField.double("ping360_sonar.bearing_deg", "Bearing off ahead, to starboard (degrees)"),
  },
}
assert(loadfile(here .. "sonard_ping.lua"))(device)
local ping360, details, messages, extra = device.proto, device.details, device.layouts.messages, device.extra

ping360.prefs.ahead = Pref.uint("Angle straight ahead (gradians)", 0,
                                "Angle at which the head looks ahead: 0 for ROS, 200 for ping-viewer")

-- All messages with an angle have it at the same offset.
local function add_bearing(tvb, tree)
  local angle = tvb(10, 2):le_uint()
  local turn = (angle - ping360.prefs.ahead) % 400
  local bearing = (turn > 200 and turn - 400 or turn) * 0.9
  tree:add(extra.bearing, tvb(10, 2), bearing):set_generated()
  return string.format("angle %d", angle)
end

local function add_samples(tvb, tree, layout)
  local text = add_bearing(tvb, tree)
  return string.format("%s, %d samples", text, device.add_data(tvb, tree, layout))
end

function details.device_information(tvb)
  return string.format("firmware %d.%d.%d", tvb(10, 1):uint(), tvb(11, 1):uint(), tvb(12, 1):uint())
end

function details.transducer(tvb, tree)
  local text = add_bearing(tvb, tree)
  return text .. (tvb(20, 1):uint() == 0 and ", moves only" or string.format(", %d samples", tvb(18, 2):le_uint()))
end

function details.auto_transmit(tvb)
  return string.format("%d to %d gradians, step %d", tvb(18, 2):le_uint(), tvb(20, 2):le_uint(), tvb(22, 1):uint())
end

function details.device_data(tvb, tree)
  return add_samples(tvb, tree, messages.device_data)
end

function details.auto_device_data(tvb, tree)
  return add_samples(tvb, tree, messages.auto_device_data)
end

-- ---- Discovery (5): text in datagrams

local discovery_prefix = "ping360_discovery"
local discovery = Proto(discovery_prefix, "Ping360 discovery")
local longest_text = 512
local found = {
  message = ProtoField.string(discovery_prefix .. ".message", "Message"),
  device = ProtoField.string(discovery_prefix .. ".device", "Device"),
  maker = ProtoField.string(discovery_prefix .. ".maker", "Maker"),
  mac = ProtoField.string(discovery_prefix .. ".mac_address", "MAC address"),
  ip = ProtoField.ipv4(discovery_prefix .. ".ip_address", "IP address"),
}
local bad_answer = ProtoExpert.new(discovery_prefix .. ".bad_answer", "Answer that known clients reject",
                                   expert.group.MALFORMED, expert.severity.WARN)
for _, field in pairs(found) do
  table.insert(discovery.fields, field)
end
discovery.experts = { bad_answer }

-- The address in a text like "192.168.002.004", or nil.
local function address_of(text)
  local groups = { text:match("^(%d+)%.(%d+)%.(%d+)%.(%d+)$") }
  for i, group in ipairs(groups) do
    groups[i] = tonumber(group, 10)
    if groups[i] > 255 then
      return nil
    end
  end
  return #groups == 4 and Address.ip(table.concat(groups, ".")) or nil
end

local function add_ip(range, tree, text)
  local address = address_of(text)
  if address then
    tree:add(found.ip, range, address)
  else
    tree:add_proto_expert_info(bad_answer, "No IP address")
  end
end

-- The contents of each line of an answer.
local lines_of_answer = {
  function(range, tree, line) tree:add(found.device, range, line) end,
  function(range, tree, line) tree:add(found.maker, range, line) end,
  function(range, tree, line)
    local mac = line:match("^MAC Address:%-%s*(%x%x%-%x%x%-%x%x%-%x%x%-%x%x%-%x%x)$")
    if mac then
      tree:add(found.mac, range, (mac:lower():gsub("-", ":")))
    else
      tree:add_proto_expert_info(bad_answer, "No MAC address")
    end
  end,
  function(range, tree, line) add_ip(range, tree, line:match("^IP Address:%-%s*(.*)$") or "") end,
}

local function add_answer(tvb, tree, text)
  local count, begin = 0, 1
  for line, after in text:gmatch("(.-)\r\n()") do
    count = count + 1
    if count <= #lines_of_answer then
      lines_of_answer[count](tvb(begin - 1, after - begin), tree, line)
    end
    begin = after
  end
  if count ~= #lines_of_answer or begin ~= #text + 1 then
    tree:add_proto_expert_info(bad_answer, "ping-viewer expects four lines, each ended by CR LF")
  end
end

-- The name of a discovery message, or nil for other texts, because other protocols share the port.
local function name_of_text(text)
  if text:match("^[%s\0]*Discovery[%s\0]*$") then
    return "discovery"
  end
  if text:match("^[%s\0]*SetSS1IP ") then
    return "set_ip"
  end
  return text:match("^[^\r\n]*PING360") and "answer"
end

function discovery.dissector(tvb, pinfo, root)
  local text = tvb:len() > 0 and tvb:len() <= longest_text and tvb:raw() or ""
  local name = name_of_text(text)
  if not name then
    return 0
  end
  pinfo.cols.protocol = "PING360"
  pinfo.cols.info = name
  local tree = root:add(discovery, tvb())
  tree:append_text(", " .. name)
  tree:add(found.message, tvb(), name):set_generated()
  if name == "answer" then
    add_answer(tvb, tree, text)
  elseif name == "set_ip" then
    add_ip(tvb(), tree, text:match("SetSS1IP (.-)[%s\0]*$"))
  end
  return tvb:len()
end

-- ---- Ports

local ports_of_heads = device.listen(ping360, { udp = "9092,12345", tcp = "" }, "Ports of heads, and of bridges of vehicles")
device.listen(discovery, { udp = "30303" }, "Ports of the discovery of heads")

table.insert(tables.serial_devices, {
  proto = ping360,
  begins_with_frame = function(tvb) return tvb:raw(0, math.min(tvb:len(), 4)):match("^BR.?[\0-\16]?$") ~= nil end,
})

-- ---- Empty datagrams (4.3). No dissector of UDP gets them, so a dissector that runs after all others finds them.

local udp_length = Field.new("udp.length")
local udp_header_size = 8
local after_all = Proto("ping360_empty", "Ping360: empty datagrams")

local function is_within(port, ranges)
  for first, last in ranges:gmatch("(%d+)%-?(%d*)") do
    if port >= tonumber(first) and port <= tonumber(last == "" and first or last) then
      return true
    end
  end
  return false
end

local function is_of_this_protocol(pinfo)
  return device.knows_ends(pinfo) or is_within(pinfo.src_port, ports_of_heads.udp) or
         is_within(pinfo.dst_port, ports_of_heads.udp)
end

function after_all.dissector(_, pinfo, root)
  local length = pinfo.port_type == 3 and udp_length()
  if length and length.value == udp_header_size and is_of_this_protocol(pinfo) then
    pinfo.cols.protocol = "PING360"
    pinfo.cols.info = "empty datagram"
    device.add_note(length.range, root, "empty datagram"):add_proto_expert_info(
      device.between_frames, "Empty datagram: ends a scan; a bridge turns it into a break")
  end
end
register_postdissector(after_all)
