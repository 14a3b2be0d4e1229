-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the serial protocol of a Micron DST, carried over TCP or UDP, in both directions. Section
-- numbers below refer to protocol/micron/README.md. Put all sonard_*.lua files into the folder for personal Lua
-- plugins, or load this one:
--   tshark -X lua_script:sonard_micron.lua -r capture.pcapng
-- Streams that begin with a frame are found on any port. The preferences of the protocol MICRON_SONAR set ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_micron_fields.lua")

local prefix = "micron_sonar"
local micron = Proto(prefix, "Micron scanning sonar")
local frame_header_size = 13
local lengths_end = 7  -- start, hexadecimal length, binary length
local length_overhead = 6  -- bytes of a frame that its length does not count
local max_frame_size = 4096   -- 2.3

local messages = layouts.messages
messages.frame = {
  minimum = frame_header_size,
  fields = {
    { 5, 2, "length" }, { 7, 1, "tx_node" }, { 8, 1, "rx_node" }, { 9, 1, "count" }, { 10, 1, "type" },
    { 11, 1, "sequence" }, { 12, 1, "node" },
  },
}
messages.head_data_counts = { minimum = 44, fields = { { 13, 2, "total_count" }, { 42, 2, "data_count" } } }
messages.bb_user_data_dst = { minimum = 147, fields = { { 146, 1, "dst_half_duplex" } } }

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  from_head = ProtoField.bool(prefix .. ".from_head", "From the head"),
  form = ProtoField.uint8(prefix .. ".head_command.form", "Form", base.HEX,
                          { [0x01] = "full", [0x1D] = "full with gain block", [0x1E] = "gain only", [0x0F] = "reverse" }),
  bearing = ProtoField.double(prefix .. ".head_data.bearing_deg", "Bearing off ahead, to starboard (degrees)"),
  bins = ProtoField.uint16(prefix .. ".head_data.bins", "Bins"),
  data = ProtoField.bytes(prefix .. ".data", "Data"),
  garbage = ProtoField.bytes(prefix .. ".garbage", "Bytes outside frames"),
}
micron.fields = tables.make_fields(prefix, messages, {
  ["frame.sequence"] = "hex", ["head_command.control"] = "hex", ["head_data.control"] = "hex",
  ["head_command.tx_word"] = "hex", ["head_command.rx_word"] = "hex", ["head_data.tx_word"] = "hex",
  ["head_data.status"] = "hex", ["alive.head_info"] = "hex", ["alive.needs_parameters"] = "hex",
  ["version_data.checksum"] = "hex",
}, extra)

local malformed = ProtoExpert.new(prefix .. ".malformed", "Shorter than its type requires", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local bad_value = ProtoExpert.new(prefix .. ".bad_value", "Invalid value",
                                  expert.group.MALFORMED, expert.severity.ERROR)
local no_frame = ProtoExpert.new(prefix .. ".no_frame", "Bytes that belong to no frame", expert.group.MALFORMED,
                                 expert.severity.WARN)
local wrong_count = ProtoExpert.new(prefix .. ".wrong_count", "Count does not fit the length",
                                    expert.group.PROTOCOL, expert.severity.NOTE)
local unknown = ProtoExpert.new(prefix .. ".unknown_type", "Type not in the protocol description",
                                expert.group.UNDECODED, expert.severity.NOTE)
micron.experts = { malformed, bad_value, no_frame, wrong_count, unknown }

-- ---- Where frames begin and end (2.3)

-- Size of the frame at `offset`; nil if its two lengths differ or are invalid. Requires lengths_end bytes.
local function stated_size(tvb, offset)
  local digits = tvb:raw(offset + 1, 4)
  local length = tvb(offset + 5, 2):le_uint()
  if not digits:match("^%x%x%x%x$") or tonumber(digits, 16) ~= length then
    return nil
  end
  local size = length + length_overhead
  return length >= 8 and size <= max_frame_size and size or nil
end

-- The kind of the bytes at `offset` ("frame", "garbage" or "more") and their number. For "more", the number is the
-- count of missing bytes, 0 if not known yet.
local function next_piece(tvb, offset)
  local left = tvb:len() - offset
  if tvb(offset, 1):uint() == 0x40 then
    if left < lengths_end then
      return "more", 0
    end
    local size = stated_size(tvb, offset)
    if size and left < size then
      return "more", size - left
    end
    if size and tvb(offset + size - 1, 1):uint() == 0x0A then
      return "frame", size
    end
  end
  local size = 1
  while size < left and tvb(offset + size, 1):uint() ~= 0x40 do
    size = size + 1
  end
  return "garbage", size
end

-- ---- The parts of each message beyond its table. `tvb` is one frame without its line feed. Each function returns a
-- text for the info column, or nil.
local details = {}

function details.head_command(tvb, pinfo, tree)
  if tvb:len() <= 13 then
    tree:add_proto_expert_info(malformed)
    return
  end
  local form = tvb(13, 1):uint()
  tree:add(extra.form, tvb(13, 1))
  local whole = true
  if form == 0x01 or form == 0x1D then
    whole = tables.add(tree, tvb, messages.head_command, 0)
    if form == 0x1D and tvb:len() >= 65 + 16 then
      tables.add(tree, tvb, messages.gain_block, 65)
    end
  elseif form == 0x1E then
    whole = tables.add(tree, tvb, messages.gain_block, 14)
  elseif form ~= 0x0F then
    tree:add_proto_expert_info(bad_value, string.format("Unknown form 0x%02x", form))
  end
  if not whole then
    tree:add_proto_expert_info(malformed)
  end
  return string.format("form 0x%02x", form)
end

function details.head_data(tvb, pinfo, tree)
  if not tables.add(tree, tvb, messages.head_data_counts, 0) then
    tree:add_proto_expert_info(malformed)
    return
  end
  local total, count = tvb(13, 2):le_uint(), tvb(42, 2):le_uint()
  local bearing = (tvb(40, 2):le_uint() - 3200) * 0.05625
  tree:add(extra.bearing, tvb(40, 2), bearing):set_generated()
  local text = string.format("bearing %d, %d bytes", tvb(40, 2):le_uint(), count)
  if total ~= count + 31 or tvb:len() ~= 44 + count then
    tree:add_proto_expert_info(malformed, string.format("%d and %d bytes of data declared, %d present", total - 31,
                                                        count, tvb:len() - 44))
    return text
  end
  local eight_bit = tables.has_bit(tvb(18, 2):le_uint(), 0)
  tree:add(extra.bins, tvb(42, 2), eight_bit and count or 2 * count):set_generated()
  if count > 0 then
    tree:add(extra.data, tvb(44, count))
  end
  return text
end

function details.bb_user_data(tvb, pinfo, tree)
  if tvb:len() == 263 then
    tables.add(tree, tvb, messages.bb_user_data_dst, 0)
  elseif tvb:len() ~= 174 then
    tree:add_proto_expert_info(malformed, "User blocks have 264 bytes, or 175 from older heads")
  end
end

function details.aux_data(tvb, pinfo, tree)
  local count = tvb:len() >= 15 and tvb(13, 2):le_uint() or -1
  if count < 0 or tvb:len() < 15 + count then
    tree:add_proto_expert_info(malformed)
  elseif count > 0 then
    tree:add(extra.data, tvb(15, count))
  end
end

function details.alive(tvb)
  return string.format("0x%02x", tvb(20, 1):uint())
end

-- ---- Frames

-- Adds a message: with a table of its own, or without one if it has no data.
local function add_message(tvb, pinfo, tree, name)
  local layout = messages[name]
  if layout and name ~= "head_command" and not tables.add(tree, tvb, layout, 0) then
    tree:add_proto_expert_info(malformed)
    return nil
  end
  return details[name] and details[name](tvb, pinfo, tree)
end

local function dissect_frame(tvb, pinfo, root)
  local tree = root:add(micron, tvb())
  local body = tvb(0, tvb:len() - 1):tvb()
  tables.add(tree, body, messages.frame, 0)
  local length, count, type = tvb(5, 2):le_uint(), tvb(9, 1):uint(), tvb(10, 1):uint()
  -- The client sends as node 255. Messages of client and head differ.
  local from_head = tvb(7, 1):uint() ~= 0xFF
  tree:add(extra.from_head, tvb(7, 1), from_head):set_generated()
  if count ~= (length - 5) % 256 and not (type == 2 and count == 0) then
    tree:add_proto_expert_info(wrong_count)
  end
  local name = (from_head and layouts.reports or layouts.commands)[type]
  if not name then
    tree:add_proto_expert_info(unknown)
    return string.format("type %d", type)
  end
  tree:add(extra.message, tvb(10, 1), name):set_generated()
  local text = add_message(body, pinfo, tree, name)
  tree:append_text(", " .. name .. (text and ": " .. text or ""))
  return name .. (text and ": " .. text or "")
end

local function add_garbage(range, root)
  local tree = root:add(micron, range)
  tree:append_text(", no frame")
  tree:add(extra.garbage, range)
  tree:add_proto_expert_info(no_frame)
  return "no frame"
end

-- Dissects a part of a stream, or a datagram. In a stream, an incomplete frame waits for the next part.
local function dissect(tvb, pinfo, root, is_stream)
  pinfo.cols.protocol = "MICRON"
  local texts = {}
  local offset = 0
  while offset < tvb:len() do
    local kind, size = next_piece(tvb, offset)
    if kind == "more" and is_stream then
      pinfo.desegment_offset = offset
      pinfo.desegment_len = size > 0 and size or DESEGMENT_ONE_MORE_SEGMENT
      break
    end
    if kind == "frame" then
      table.insert(texts, dissect_frame(tvb(offset, size):tvb(), pinfo, root))
    else
      size = kind == "garbage" and size or tvb:len() - offset
      table.insert(texts, add_garbage(tvb(offset, size), root))
    end
    offset = offset + size
  end
  if #texts > 0 then
    pinfo.cols.info = table.concat(texts, "; ")
  end
  return tvb:len()
end

-- Wireshark calls this for TCP and UDP ports; the type of the port shows which. Any serial device may use the ports,
-- so frames of another device go to its dissector, which then keeps that conversation.
function micron.dissector(tvb, pinfo, root)
  for _, other in ipairs(tables.serial_devices) do
    if other.begins_with_frame(tvb) then
      return other.proto.dissector(tvb, pinfo, root)
    end
  end
  return dissect(tvb, pinfo, root, pinfo.port_type == 2)
end

-- ---- Ports: of device servers for TCP, and of sonard's examples for UDP

local dissector_tables = { tcp = DissectorTable.get("tcp.port"), udp = DissectorTable.get("udp.port") }
local ports_in_use = { tcp = "4001", udp = "4002" }
micron.prefs.tcp = Pref.range("TCP ports", ports_in_use.tcp, "Ports that serial device servers listen on", 65535)
micron.prefs.udp = Pref.range("UDP ports", ports_in_use.udp, "Ports that serial device servers listen on", 65535)
for transport, dissector_table in pairs(dissector_tables) do
  dissector_table:add(ports_in_use[transport], micron)
end
function micron.prefs_changed()
  for transport, dissector_table in pairs(dissector_tables) do
    dissector_table:remove(ports_in_use[transport], micron)
    ports_in_use[transport] = micron.prefs[transport]
    dissector_table:add(ports_in_use[transport], micron)
  end
end

-- Whether it begins with a start and two equal lengths, on any port.
local function begins_with_frame(tvb)
  return tvb:len() >= 14 and tvb(0, 1):uint() == 0x40 and stated_size(tvb, 0) ~= nil
end
for transport in pairs(dissector_tables) do
  micron:register_heuristic(transport, function(tvb, pinfo, root)
    if not begins_with_frame(tvb) then
      return false
    end
    pinfo.conversation = micron
    micron.dissector(tvb, pinfo, root)
    return true
  end)
end
