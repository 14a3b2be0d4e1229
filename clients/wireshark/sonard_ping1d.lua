-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the Ping protocol of a Ping1D or Ping2, over UDP or TCP, in both directions. Section numbers
-- refer to docs/protocols/ping1d.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this:
--   tshark -X lua_script:sonard_ping1d.lua -r capture.pcapng
-- Packets that begin with a message of these devices alone are found on any port; the preferences of the protocol
-- PING1D_SONAR set ports. A datagram with a piece of a frame is shown as bytes outside frames.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_ping1d_fields.lua")

local prefix = "ping1d_sonar"
local ping1d = Proto(prefix, "Ping1D echo sounder")
local header_size, checksum_size = 8, 2
local overhead = header_size + checksum_size
local max_payload_size = 4096
local least_own_id = 1000  -- smaller ones are common to all devices of the Ping protocol

local messages = layouts.messages
messages.frame = {
  minimum = header_size,
  fields = { { 2, 2, "payload_length" }, { 4, 2, "message_id" }, { 6, 1, "source" }, { 7, 1, "destination" } },
}
-- The count of the points follows the table of a profile (2.3).
local profile = messages.profile
table.insert(profile.fields, { profile.size, 2, "data_length" })
profile.size = profile.size + 2
profile.minimum = profile.size
local has_rest = { profile = true, nack = true, ascii_text = true }

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  from_head = ProtoField.bool(prefix .. ".from_head", "From the head"),
  checksum = ProtoField.uint16(prefix .. ".checksum", "Checksum", base.HEX),
  about = ProtoField.string(prefix .. ".about", "Subject message"),
  text = ProtoField.string(prefix .. ".text", "Text"),
  data = ProtoField.bytes(prefix .. ".data", "Points"),
  garbage = ProtoField.bytes(prefix .. ".garbage", "Bytes outside frames"),
}
ping1d.fields = tables.make_fields(prefix, messages, {}, extra)

local bad_checksum = ProtoExpert.new(prefix .. ".bad_checksum", "Wrong checksum: receivers drop this frame",
                                     expert.group.CHECKSUM, expert.severity.ERROR)
local malformed = ProtoExpert.new(prefix .. ".malformed", "Shorter than its message", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local no_frame = ProtoExpert.new(prefix .. ".no_frame", "Bytes that belong to no frame", expert.group.MALFORMED,
                                 expert.severity.WARN)
local unknown = ProtoExpert.new(prefix .. ".unknown_id", "Message not in the protocol description",
                                expert.group.UNDECODED, expert.severity.NOTE)
ping1d.experts = { bad_checksum, malformed, no_frame, unknown }

local function u16(raw, offset)
  local low, high = raw:byte(offset + 1, offset + 2)
  return low + 256 * high
end

-- Size of the frame at `offset`; 0 if too few bytes are there to give it, nil if no frame begins.
local function stated_size(raw, offset)
  local front = raw:sub(offset + 1, offset + 4)
  if front == "" or front:sub(1, 2) ~= ("BR"):sub(1, #front) then
    return nil
  end
  if #front < 4 then
    return 0
  end
  local length = u16(raw, offset + 2)
  return length <= max_payload_size and length + overhead or nil
end

local function sum_of(raw, offset, size)
  local sum = 0
  for i = offset + 1, offset + size - checksum_size do
    sum = sum + raw:byte(i)
  end
  return sum % 65536
end

local function name_of(id)
  return layouts.reports[id] or layouts.commands[id] or string.format("message %d", id)
end

-- ---- The parts of each message beyond its table. Each returns a text for the info column.
local details = {}

local function add_about(tvb, tree)
  local name = name_of(tvb(8, 2):le_uint())
  tree:add(extra.about, tvb(8, 2), name):set_generated()
  return name
end
details.general_request = add_about
details.ack = add_about
details.continuous_start = add_about
details.continuous_stop = add_about

local function add_text(tvb, tree, offset)
  if tvb:len() == offset then
    return ""
  end
  tree:add_packet_field(extra.text, tvb(offset), ENC_ASCII)
  return '"' .. tvb:raw(offset, tvb:len() - offset):gsub("[^\32-\126]", "?") .. '"'
end

function details.nack(tvb, tree)
  return add_about(tvb, tree) .. ", " .. add_text(tvb, tree, messages.nack.size)
end

function details.ascii_text(tvb, tree)
  return add_text(tvb, tree, header_size)
end

local function distance_text(tvb)
  return string.format("%.3f m, %d %%", tvb(8, 4):le_uint() / 1000, tvb(12, 1):uint())
end
details.distance_simple = distance_text
details.distance = distance_text

function details.profile(tvb, tree)
  local count, there = tvb(profile.size - 2, 2):le_uint(), tvb:len() - profile.size
  if there < count then
    tree:add_proto_expert_info(malformed, string.format("%d points declared, %d present", count, there))
  end
  if math.min(there, count) > 0 then
    tree:add(extra.data, tvb(profile.size, math.min(there, count)))
  end
  return string.format("%s, %d points", distance_text(tvb), count)
end

-- ---- Frames

-- Adds a message by its table, if it has one. Returns a text, or nil.
local function add_message(tvb, tree, name)
  local layout = messages[name]
  if layout and not tables.add(tree, tvb, layout, 0) then
    tree:add_proto_expert_info(malformed)
    return nil
  end
  return details[name] and details[name](tvb, tree)
end

local function dissect_frame(stream, raw, offset, size, root)
  local tvb = stream(offset, size):tvb()
  local tree = root:add(ping1d, tvb())
  local body = tvb(0, size - checksum_size):tvb()
  tables.add(tree, body, messages.frame, 0)
  local length, id, source = tvb(2, 2):le_uint(), tvb(4, 2):le_uint(), tvb(6, 1):uint()
  -- An empty message with the number of a report is an older form of the request for it (3.1).
  local asked = length == 0 and source == 0 and layouts.reports[id]
  local from_head = not asked and layouts.reports[id] ~= nil
  tree:add(extra.from_head, tvb(4, 2), from_head):set_generated()
  local name = asked and "general_request" or (layouts.reports[id] or layouts.commands[id])
  local text = name or name_of(id)
  if name then
    tree:add(extra.message, tvb(4, 2), name):set_generated()
  else
    tree:add_proto_expert_info(unknown)
  end
  if asked then
    tree:add(extra.about, tvb(4, 2), asked):set_generated()
    text = text .. ": " .. asked .. ", in an older spelling"
  elseif name then
    local more = add_message(body, tree, name)
    text = text .. (more and ": " .. more or "")
  end
  local checksum = tree:add_le(extra.checksum, tvb(size - checksum_size, checksum_size))
  if sum_of(raw, offset, size) ~= u16(raw, offset + size - checksum_size) then
    checksum:add_proto_expert_info(bad_checksum)
    text = text .. ", wrong checksum"
  end
  tree:append_text(", " .. text)
  return text
end

local function add_garbage(range, root)
  local tree = root:add(ping1d, range)
  tree:append_text(", no frame")
  tree:add(extra.garbage, range):add_proto_expert_info(no_frame)
  return "no frame"
end

-- Dissects a stream. Returns the offset of an incomplete frame, and the number of its missing bytes if it is known.
local function dissect_stream(tvb, root, texts)
  local raw, offset = tvb:raw(), 0
  while offset < #raw do
    local size = stated_size(raw, offset)
    if size and (size == 0 or offset + size > #raw) then
      return offset, size > 0 and offset + size - #raw or nil
    end
    if size then
      table.insert(texts, dissect_frame(tvb, raw, offset, size, root))
    else
      local following = (raw:find("BR", offset + 2, true) or #raw + 1) - 1
      size = following - offset
      table.insert(texts, add_garbage(tvb(offset, size), root))
    end
    offset = offset + size
  end
  return offset
end

function ping1d.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "PING1D"
  pinfo.conversation = ping1d
  local texts = {}
  local offset, missing = dissect_stream(tvb, root, texts)
  if offset < tvb:len() then
    if pinfo.port_type == 2 then  -- TCP
      pinfo.desegment_offset = offset
      pinfo.desegment_len = missing or DESEGMENT_ONE_MORE_SEGMENT
    else
      table.insert(texts, add_garbage(tvb(offset), root))
    end
  end
  if #texts > 0 then
    pinfo.cols.info = table.concat(texts, "; ")
  end
  return tvb:len()
end

-- ---- Ports (4)

local udp_ports = "6676,9090"
local udp_table = DissectorTable.get("udp.port")
ping1d.prefs.udp = Pref.range("UDP ports", udp_ports, "Ports of heads, and of bridges of vehicles", 65535)
udp_table:add(udp_ports, ping1d)
function ping1d.prefs_changed()
  if udp_ports ~= "" then
    udp_table:remove(udp_ports, ping1d)
  end
  udp_ports = ping1d.prefs.udp
  if udp_ports ~= "" then
    udp_table:add(udp_ports, ping1d)
  end
end

-- Whether a packet begins with a message that no other device of the Ping protocol has.
local function is_ours(tvb)
  local raw = tvb:raw(0, math.min(tvb:len(), header_size))
  local size = #raw == header_size and stated_size(raw, 0)
  local id = size and u16(raw, 4) or 0
  local name = layouts.reports[id] or layouts.commands[id]
  if not name or id < least_own_id then
    return false
  end
  local needed = (messages[name] and messages[name].size or header_size) + checksum_size
  return size == needed or (has_rest[name] and size > needed) or (size == overhead and layouts.reports[id] ~= nil)
end

for _, transport in ipairs({ "tcp", "udp" }) do
  ping1d:register_heuristic(transport, function(tvb, pinfo, root)
    if not is_ours(tvb) then
      return false
    end
    ping1d.dissector(tvb, pinfo, root)
    return true
  end)
end
