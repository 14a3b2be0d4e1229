-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for an Oculus: fires and pings over TCP, status datagrams over UDP. Section numbers below refer
-- to protocol/oculus/README.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this one:
--   tshark -X lua_script:sonard_oculus.lua -r capture.pcapng
-- The preferences of the protocol OCULUS_SONAR set the ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_oculus_fields.lua")

local prefix = "oculus_sonar"
local oculus = Proto(prefix, "Oculus imaging sonar")
local header_size = 16
local longest_message = 16 * 1024 * 1024
local start = "SO"

local messages = layouts.messages
local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  from_head = ProtoField.bool(prefix .. ".from_head", "From the head"),
  version = ProtoField.uint8(prefix .. ".body_version", "Version by length"),
  bearings = ProtoField.bytes(prefix .. ".bearings", "Bearings, hundredths of a degree"),
  first = ProtoField.double(prefix .. ".first_bearing_deg", "First bearing (degrees, positive to starboard)"),
  last = ProtoField.double(prefix .. ".last_bearing_deg", "Last bearing (degrees)"),
  bits = ProtoField.uint8(prefix .. ".bits", "Bits of a sample"),
  image = ProtoField.bytes(prefix .. ".image", "Image"),
  text = ProtoField.string(prefix .. ".text", "Text"),
  address = ProtoField.ipv4(prefix .. ".address", "Address of the head"),
  client = ProtoField.ipv4(prefix .. ".client", "Address of its client"),
  garbage = ProtoField.bytes(prefix .. ".garbage", "Bytes outside messages"),
  body = ProtoField.bytes(prefix .. ".body", "Body"),
}

local formats = { ["header.oculusId"] = "hex", ["header.msgId"] = "hex", ["fire.flags"] = "hex",
                  ["fire_extension.extFlags"] = "hex", ["status.status"] = "hex" }
for message, names in pairs({
  fire = { "range", "gainPercent", "speedOfSound", "salinity" },
  result_v1 = { "frequency", "temperature", "pressure", "speedOfSoundUsed", "rangeResolution" },
  result_v2 = { "frequency", "temperature", "pressure", "heading", "pitch", "roll", "speedOfSoundUsed", "pingStartTime",
                "rangeResolution" },
  status = { "temperature", "pressure" },
}) do
  for _, name in ipairs(names) do
    formats[message .. "." .. name] = "double"
  end
end
oculus.fields = tables.make_fields(prefix, messages, formats, extra)

local malformed = ProtoExpert.new(prefix .. ".malformed", "Shorter than its kind requires", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local no_message = ProtoExpert.new(prefix .. ".no_message", "Bytes that belong to no message", expert.group.MALFORMED,
                                   expert.severity.WARN)
local wrong_size = ProtoExpert.new(prefix .. ".wrong_size", "Sizes that do not fit each other; clients drop the ping",
                                   expert.group.PROTOCOL, expert.severity.WARN)
local unstated = ProtoExpert.new(prefix .. ".unstated_size", "The size is not stated: it follows from the kind (3.1)",
                                 expert.group.PROTOCOL, expert.severity.CHAT)
local unknown = ProtoExpert.new(prefix .. ".unknown_message", "Message not in the protocol description",
                                expert.group.UNDECODED, expert.severity.NOTE)
oculus.experts = { malformed, no_message, wrong_size, unstated, unknown }

local function name_of(id)
  return layouts.reports[id] or layouts.commands[id]
end

-- ---- Where messages begin and end (3.1)

-- Size in bytes of the message at `offset`, and whether its header states this size. Requires a header there.
local function message_size(tvb, offset)
  local id, version, payload = tvb(offset + 6, 2):le_uint(), tvb(offset + 8, 2):le_uint(), tvb(offset + 10, 4):le_uint()
  if payload == 0 and name_of(id) == "simple_fire" then
    return (version == 2 and messages.fire_extension or messages.fire).size, false
  end
  if payload == 0 and name_of(id) == "user_config" then
    return messages.user_config.size, false
  end
  return header_size + payload, true
end

-- The kind of the bytes at `offset` ("message", "garbage" or "more") and their number. For "more", the number is the
-- count of missing bytes, 0 if not known yet.
local function next_piece(tvb, offset)
  local left = tvb:len() - offset
  local raw = tvb:raw(offset, math.min(left, 2))
  if raw == start:sub(1, #raw) then
    if left < header_size then
      return "more", 0
    end
    local size = message_size(tvb, offset)
    if size <= longest_message then
      return size <= left and "message" or "more", size <= left and size or size - left
    end
  end
  local found = tvb:raw(offset + 1, left - 1):find(start, 1, true)
  return "garbage", found or left
end

-- ---- The parts of each message beyond its table. `tvb` is one message. Each function returns a text for the info
-- column.
local details = {}

local function add(tree, tvb, name)
  if not tables.add(tree, tvb, messages[name], 0) then
    tree:add_proto_expert_info(malformed)
    return false
  end
  return true
end

function details.simple_fire(tvb, tree)
  if not add(tree, tvb, "fire") then
    return ""
  end
  local second = tvb:len() >= messages.fire_extension.size
  if second then
    add(tree, tvb, "fire_extension")
  end
  tree:add(extra.version, tvb(0, header_size), second and 2 or 1):set_generated()
  return string.format("mode %d, rate %d, range %g, gain %g", tvb(16, 1):uint(), tvb(17, 1):uint(), tvb(21, 8):le_float(),
                       tvb(29, 8):le_float())
end

local function add_bearings(tvb, tree, offset, beams)
  if beams == 0 or offset + 2 * beams > tvb:len() then
    tree:add_proto_expert_info(malformed, "The bearings are missing")
    return
  end
  tree:add(extra.bearings, tvb(offset, 2 * beams))
  tree:add(extra.first, tvb(offset, 2), tvb(offset, 2):le_int() / 100):set_generated()
  tree:add(extra.last, tvb(offset + 2 * beams - 2, 2), tvb(offset + 2 * beams - 2, 2):le_int() / 100):set_generated()
end

-- Offsets of dataSize, nRanges, nBeams, imageOffset, imageSize and messageSize.
local places = { [1] = { 97, 106, 108, 110, 114, 118 }, [2] = { 161, 170, 172, 190, 194, 198 } }

function details.simple_ping_result(tvb, tree)
  local version = tvb(8, 2):le_uint() == 2 and 2 or 1
  tree:add(extra.version, tvb(8, 2), version):set_generated()
  if not add(tree, tvb, "fire") or (version == 2 and not add(tree, tvb, "fire_extension")) or
     not add(tree, tvb, "result_v" .. version) then
    return ""
  end
  local at = places[version]
  local width = tvb(at[1], 1):uint() + 1
  local ranges, beams = tvb(at[2], 2):le_uint(), tvb(at[3], 2):le_uint()
  local offset, size = tvb(at[4], 4):le_uint(), tvb(at[5], 4):le_uint()
  tree:add(extra.bits, tvb(at[1], 1), 8 * width):set_generated()
  add_bearings(tvb, tree, messages["result_v" .. version].size, beams)
  local gain = tables.has_bit(tvb(20, 1):uint(), 2) and 4 or 0
  if size ~= ranges * (beams * width + gain) or offset + size ~= tvb:len() or tvb(at[6], 4):le_uint() ~= tvb:len() then
    tree:add_proto_expert_info(wrong_size)
  end
  if size > 0 and offset + size <= tvb:len() then
    tree:add(extra.image, tvb(offset, size))
  end
  return string.format("ping %d, %d x %d of %d bits", tvb(version == 2 and 89 or 53, 4):le_uint(), ranges, beams, 8 * width)
end

function details.user_config(tvb, tree)
  add(tree, tvb, "user_config")
  if tvb:len() >= 20 then
    tree:add(extra.address, tvb(16, 4))
    return tostring(tvb(16, 4):ipv4())
  end
  return ""
end

function details.status(tvb, tree)
  if not add(tree, tvb, "status") then
    return ""
  end
  tree:add(extra.address, tvb(52, 4))
  tree:add(extra.client, tvb(60, 4))
  return string.format("head %d at %s", tvb(16, 4):le_uint(), tvb(52, 4):ipv4())
end

function details.logs(tvb, tree)
  if tvb:len() > header_size then
    tree:add(extra.text, tvb(header_size))
    return (tvb:raw(header_size):gsub("%c", " "))
  end
  return ""
end

function details.dummy()
  return ""
end

-- ---- One message, a stream of them, a datagram

local function dissect_message(tvb, root, from_head)
  local tree = root:add(oculus, tvb())
  add(tree, tvb, "header")
  local id = tvb(6, 2):le_uint()
  local name = name_of(id)
  tree:add(extra.from_head, tvb(2, 2), from_head):set_generated()
  if not name then
    tree:add_proto_expert_info(unknown)
    if tvb:len() > header_size then
      tree:add(extra.body, tvb(header_size))
    end
    return string.format("message 0x%02x", id)
  end
  tree:add(extra.message, tvb(6, 2), name):set_generated()
  local _, stated = message_size(tvb, 0)
  if not stated then
    tree:add_proto_expert_info(unstated)
  end
  local more = details[name](tvb, tree)
  local text = more == "" and name or name .. ": " .. more
  tree:append_text(", " .. text)
  return text
end

local function add_garbage(range, root)
  local tree = root:add(oculus, range)
  tree:add(extra.garbage, range)
  tree:add_proto_expert_info(no_message)
  tree:append_text(", no message")
  return "no message"
end

local ports = { tcp = "52100", udp = "52102" }

local function is_within(port, ranges)
  for first, last in ranges:gmatch("(%d+)%-?(%d*)") do
    if port >= tonumber(first) and port <= tonumber(last == "" and first or last) then
      return true
    end
  end
  return false
end

local function dissect_stream(tvb, pinfo, root, texts)
  local from_head = is_within(pinfo.src_port, ports.tcp)
  local offset = 0
  while offset < tvb:len() do
    local kind, size = next_piece(tvb, offset)
    if kind == "more" then
      pinfo.desegment_offset = offset
      pinfo.desegment_len = size > 0 and size or DESEGMENT_ONE_MORE_SEGMENT
      return
    end
    local piece = tvb(offset, size)
    table.insert(texts, kind == "message" and dissect_message(piece:tvb(), root, from_head) or add_garbage(piece, root))
    offset = offset + size
  end
end

function oculus.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "OCULUS"
  local texts = {}
  -- Wireshark calls this for TCP and UDP ports; the type of the port shows which.
  if pinfo.port_type == 2 then
    dissect_stream(tvb, pinfo, root, texts)
  elseif tvb:len() >= header_size and tvb:raw(0, 2) == start then
    table.insert(texts, dissect_message(tvb, root, true))
  elseif tvb:len() > 0 then
    table.insert(texts, add_garbage(tvb(), root))
  end
  if #texts > 0 then
    pinfo.cols.info = table.concat(texts, "; ")
  end
  return tvb:len()
end

local in_use = {}
local function listen()
  for transport in pairs(ports) do
    local dissector_table = DissectorTable.get(transport .. ".port")
    if in_use[transport] and in_use[transport] ~= "" then
      dissector_table:remove(in_use[transport], oculus)
    end
    in_use[transport] = oculus.prefs[transport]
    ports[transport] = in_use[transport]
    if in_use[transport] ~= "" then
      dissector_table:add(in_use[transport], oculus)
    end
  end
end
oculus.prefs.tcp = Pref.range("TCP ports", ports.tcp, "Ports of heads", 65535)
oculus.prefs.udp = Pref.range("UDP ports", ports.udp, "Ports that receive status packets", 65535)
oculus.prefs_changed = listen
for transport, default in pairs(ports) do
  in_use[transport] = default
  DissectorTable.get(transport .. ".port"):add(default, oculus)
end
