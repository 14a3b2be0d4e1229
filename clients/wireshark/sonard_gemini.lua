-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the messages of a Gemini 720i, in both directions. Section numbers below refer to
-- protocol/gemini/README.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this one:
--   tshark -X lua_script:sonard_gemini.lua -r capture.pcapng
-- The preferences of the protocol GEMINI_SONAR set the UDP ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_gemini_fields.lua")

local prefix = "gemini_sonar"
local gemini = Proto(prefix, "Gemini imaging sonar")
local header_size = 8

-- Messages that a table cannot describe alone (3.7, 3.8, 3.11).
local info_blocks = {
  [0] = { minimum = 28, fields = { { 16, 4, "sonar_id" }, { 20, 4, "transducer" } } },
  [1] = { minimum = 24, fields = { { 16, 4, "m_coefficient" }, { 20, 4, "c_coefficient" } } },
  [2] = { minimum = 24, fields = { { 16, 4, "alternate_ip" }, { 20, 4, "subnet_mask" } } },
}
local messages = layouts.messages
messages.header = {
  minimum = header_size,
  fields = {
    { 0, 1, "type" }, { 1, 1, "version" }, { 2, 2, "sonar_id" }, { 4, 2, "packet_latency" }, { 6, 1, "destination" },
    { 7, 1, "source" },
  },
}
messages.info_block_write = { minimum = 16, fields = { { 8, 4, "bank" }, { 12, 2, "flags" } } }
messages.info_block_write_identity = info_blocks[0]
messages.info_block_write_velocimeter = info_blocks[1]
messages.info_block_write_address = info_blocks[2]
messages.serial_transmit = { minimum = 9, fields = { { 8, 1, "length" } } }
messages.mdio_commands = { minimum = 10, fields = { { 8, 2, "length" } } }
messages.serial_data = { minimum = 8, fields = {} }

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  status_mac = ProtoField.string(prefix .. ".status.mac_address", "MAC address"),
  head_lines = ProtoField.uint16(prefix .. ".ping_head.lines", "Lines that follow"),
  head_sound_speed = ProtoField.double(prefix .. ".ping_head.sound_speed_mps", "Sound speed used (m/s)"),
  line_number = ProtoField.uint16(prefix .. ".ping_line.number", "Line number"),
  line_resent = ProtoField.bool(prefix .. ".ping_line.resent", "Sent again"),
  line_last = ProtoField.bool(prefix .. ".ping_line.last", "Last line"),
  line_length = ProtoField.uint16(prefix .. ".ping_line.data_length", "Bytes of data"),
  line_data = ProtoField.bytes(prefix .. ".ping_line.data", "Data"),
  line_beams = ProtoField.uint16(prefix .. ".ping_line.beams_coded", "Beams after run-length decoding"),
  line_head = ProtoField.framenum(prefix .. ".ping_line.head_frame", "Head of the ping", base.NONE, frametype.REQUEST),
  tail_resent = ProtoField.bool(prefix .. ".ping_tail.resent", "Sent again"),
  serial_bytes = ProtoField.bytes(prefix .. ".serial_transmit.data", "Data"),
  mdio_word = ProtoField.uint16(prefix .. ".mdio_commands.word", "Word", base.HEX),
  serial_time = ProtoField.uint64(prefix .. ".serial_data.time_us", "Time (us)"),
  serial_value = ProtoField.uint8(prefix .. ".serial_data.value", "Byte", base.HEX),
}
gemini.fields = tables.make_fields(prefix, messages, {
  ["header.type"] = "hex", ["ping_config.run_mode"] = "hex", ["ping_config.ext_mode"] = "hex",
  ["ping_config.main_gain"] = "hex", ["ping_config.range_compression"] = "hex", ["ping_head.ext_mode"] = "hex",
  ["ping_line.line_id"] = "hex", ["ping_line.line_info"] = "hex", ["ping_tail.flags"] = "hex",
  ["status.fixed_ip"] = "ipv4", ["status.alternate_ip"] = "ipv4", ["status.surface_ip"] = "ipv4",
  ["status.subnet_mask"] = "ipv4", ["status.flags"] = "hex", ["status.boot_status"] = "hex",
  ["status.shutdown_status"] = "hex", ["status.link_type"] = "hex",
  ["info_block_write_address.alternate_ip"] = "ipv4", ["info_block_write_address.subnet_mask"] = "ipv4",
}, extra)

local malformed = ProtoExpert.new(prefix .. ".malformed", "Shorter than its type requires", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local bad_value = ProtoExpert.new(prefix .. ".bad_value", "Invalid value",
                                  expert.group.MALFORMED, expert.severity.ERROR)
local bad_line = ProtoExpert.new(prefix .. ".bad_line", "Line does not fit the head of its ping",
                                 expert.group.PROTOCOL, expert.severity.WARN)
local unknown = ProtoExpert.new(prefix .. ".unknown_type", "Type not in the protocol description",
                                expert.group.UNDECODED, expert.severity.NOTE)
gemini.experts = { malformed, bad_value, bad_line, unknown }

-- Heads of pings by sonar and ping, and for each frame with a line the head before it. Filled in the first pass
-- over a capture.
local heads = {}
local head_of_frame = {}
function gemini.init()
  heads = {}
  head_of_frame = {}
end

local function head_key(tvb, ping_id)
  return tvb(2, 2):le_uint() * 256 + ping_id % 256
end

-- Compression as a power of two (6.1).
local function compression_log2(byte)
  local k = byte % 8
  return k <= 4 and k or 0
end

-- Number of beams in the run-length coded `bytes`, at most `beams` (6.8).
local function coded_beams(bytes, beams)
  local count, i = 0, 0
  while i < bytes:len() and count < beams do
    local byte = bytes:get_index(i)
    if byte == 0 then
      i = i + 1
      count = count + (i < bytes:len() and bytes:get_index(i) or 0)
    else
      count = count + 1
    end
    i = i + 1
  end
  return count
end

-- The parts of each message beyond its table. Each function returns a text for the info column, or nil.
local details = {}

function details.status(tvb, pinfo, tree)
  local octets = {}
  for i = 105, 100, -1 do
    table.insert(octets, string.format("%02x", tvb(i, 1):uint()))
  end
  tree:add(extra.status_mac, tvb(100, 6), table.concat(octets, ":"))
end

function details.ping_head(tvb, pinfo, tree)
  local first, last = tvb(20, 2):le_uint(), tvb(22, 2):le_uint()
  local head = {
    frame = pinfo.number,
    lines = math.floor(math.max(last - first, 0) / 2 ^ compression_log2(tvb(45, 1):uint())),
    beams = tvb(28, 2):le_uint(),
    run_length = tvb(44, 1):uint() ~= 0,
    eight_bit = tables.has_bit(tvb(10, 2):le_uint(), 2),
  }
  local ping_id = tvb(8, 2):le_uint()
  if not pinfo.visited then
    heads[head_key(tvb, ping_id)] = head
  end
  tree:add(extra.head_lines, tvb(20, 4), head.lines):set_generated()
  tree:add(extra.head_sound_speed, tvb(42, 2), (tvb(42, 2):le_uint() % 32768) / 10):set_generated()
  return string.format("ping %d, %d lines of %d beams", ping_id, head.lines, head.beams)
end

-- Compares a line with the head of its ping.
local function check_line(tvb, tree, head, number, length)
  if number >= head.lines then
    tree:add_proto_expert_info(bad_line, string.format("Line %d of %d", number, head.lines))
  end
  if head.run_length then
    local beams = coded_beams(tvb(16, length):bytes(), head.beams)
    tree:add(extra.line_beams, tvb(16, length), beams):set_generated()
    if beams ~= head.beams then
      tree:add_proto_expert_info(bad_line, string.format("%d beams of %d", beams, head.beams))
    end
  elseif length ~= head.beams * (head.eight_bit and 1 or 2) then
    tree:add_proto_expert_info(bad_line, string.format("%d bytes for %d beams", length, head.beams))
  end
end

function details.ping_line(tvb, pinfo, tree)
  local id, info = tvb(10, 2):le_uint(), tvb(14, 2):le_uint()
  local number, resent = id % 32768, tables.has_bit(id, 15)
  local length = math.floor(info / 128) * 4
  tree:add(extra.line_number, tvb(10, 2), number):set_generated()
  tree:add(extra.line_resent, tvb(10, 2), resent):set_generated()
  tree:add(extra.line_last, tvb(14, 2), tables.has_bit(info, 6)):set_generated()
  tree:add(extra.line_length, tvb(14, 2), length):set_generated()
  local ping_id = tvb(9, 1):uint()
  local text = string.format("ping %d, line %d", ping_id, number)
  if tvb:len() - 16 < length then
    tree:add_proto_expert_info(malformed, string.format("%d bytes of data declared, %d present", length,
                                                        tvb:len() - 16))
    return text
  end
  if length > 0 then
    tree:add(extra.line_data, tvb(16, length))
  end
  if not pinfo.visited then
    head_of_frame[pinfo.number] = heads[head_key(tvb, ping_id)]
  end
  local head = head_of_frame[pinfo.number]
  if head then
    tree:add(extra.line_head, head.frame):set_generated()
    check_line(tvb, tree, head, number, length)
    text = text .. " of " .. head.lines
  end
  return text .. (resent and ", sent again" or "")
end

function details.ping_tail(tvb, pinfo, tree)
  local resent = tables.has_bit(tvb(9, 1):uint(), 7)
  tree:add(extra.tail_resent, tvb(9, 1), resent):set_generated()
  return string.format("ping %d", tvb(8, 1):uint()) .. (resent and ", sent again" or "")
end

function details.ping_config(tvb)
  return string.format("%d lines, mode %d", tvb(22, 2):le_uint(), tvb(16, 2):le_uint() % 4)
end

function details.retry_request(tvb)
  local kinds = { [0] = "head", [1] = "lines", [2] = "tail" }
  local kind = tvb(8, 2):le_uint()
  if kind == 1 then
    return string.format("lines from %d, %d of them", tvb(10, 2):le_uint(), tvb(12, 2):le_uint())
  end
  return kinds[kind] or "unknown kind"
end

function details.info_block_write(tvb, pinfo, tree)
  local bank = tvb(8, 4):le_uint()
  local block = info_blocks[bank]
  if not block then
    tree:add_proto_expert_info(bad_value, string.format("Unknown bank %d", bank))
  elseif not tables.add(tree, tvb, block, 0) then
    tree:add_proto_expert_info(malformed)
  end
  return string.format("bank %d", bank)
end

function details.serial_transmit(tvb, pinfo, tree)
  local length = tvb(8, 1):uint()
  if tvb:len() < 9 + length then
    tree:add_proto_expert_info(malformed)
  elseif length > 0 then
    tree:add(extra.serial_bytes, tvb(9, length))
  end
end

function details.mdio_commands(tvb, pinfo, tree)
  local length = tvb(8, 2):le_uint()
  if length < 2 or length % 2 ~= 0 then
    tree:add_proto_expert_info(bad_value, string.format("Invalid length %d", length))
  elseif tvb:len() < 8 + length then
    tree:add_proto_expert_info(malformed)
  else
    for offset = 10, 6 + length, 2 do
      tree:add_le(extra.mdio_word, tvb(offset, 2))
    end
  end
end

function details.serial_data(tvb, pinfo, tree)
  local offset = header_size
  while offset + 8 <= tvb:len() do
    tree:add_le(extra.serial_time, tvb(offset, 7))
    tree:add(extra.serial_value, tvb(offset + 7, 1))
    offset = offset + 8
  end
  if offset < tvb:len() then
    tree:add_proto_expert_info(malformed)
  end
end

function gemini.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "GEMINI"
  local tree = root:add(gemini, tvb())
  if not tables.add(tree, tvb, messages.header, 0) then
    tree:add_proto_expert_info(malformed)
    return
  end
  local type = tvb(0, 1):uint()
  local name = layouts.commands[type] or layouts.reports[type]
  if not name then
    pinfo.cols.info = string.format("unknown type 0x%02x", type)
    tree:add_proto_expert_info(unknown)
    return
  end
  pinfo.cols.info = name
  tree:append_text(", " .. name)
  tree:add(extra.message, tvb(0, 1), name):set_generated()
  if not tables.add(tree, tvb, messages[name], 0) then
    tree:add_proto_expert_info(malformed)
    return
  end
  local text = details[name] and details[name](tvb, pinfo, tree)
  if text then
    pinfo.cols.info:append(": " .. text)
    tree:append_text(": " .. text)
  end
end

-- UDP ports of heads and clients (1.1).
local udp_ports = DissectorTable.get("udp.port")
local ports_in_use = "52900,52901"
gemini.prefs.ports = Pref.range("UDP ports", ports_in_use, "Ports that clients and heads listen on", 65535)
udp_ports:add(ports_in_use, gemini)
function gemini.prefs_changed()
  udp_ports:remove(ports_in_use, gemini)
  ports_in_use = gemini.prefs.ports
  udp_ports:add(ports_in_use, gemini)
end
