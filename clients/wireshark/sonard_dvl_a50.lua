-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for a Water Linked DVL A50 or A125: JSON, PD6 and PD4 over TCP, in both directions, and the
-- sentences of its serial line over UDP or TCP. Wireshark itself shows its HTTP. Section numbers refer to
-- protocol/dvl_a50/README.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this one:
--   tshark -X lua_script:sonard_dvl_a50.lua -r capture.pcapng
-- The preferences of the protocol DVL_A50_SONAR set the ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_dvl_a50_fields.lua")

local prefix = "dvl_a50_sonar"
local dvl = Proto(prefix, "DVL A50")
local pd4 = layouts.messages.pd4
local pd4_start = "\125\0"
local pd6_lines = 10
local longest_object = 64000  -- 1

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  from_head = ProtoField.bool(prefix .. ".from_head", "From the device"),
  text = ProtoField.string(prefix .. ".text", "Text"),
  response_to = ProtoField.string(prefix .. ".response_to", "Response to"),
  garbage = ProtoField.bytes(prefix .. ".garbage", "Bytes outside messages"),
}
-- Members of reports and responses that a filter can use, by their type.
local members = {
  { "time", "vx", "vy", "vz", "fom", "altitude", "ts", "x", "y", "z", "std", "roll", "pitch", "yaw" },
  { "velocity_valid", "success" },
}
local numbers, booleans = {}, {}
for _, name in ipairs(members[1]) do
  numbers[name] = ProtoField.double(prefix .. "." .. name, name)
  extra["number_" .. name] = numbers[name]
end
for _, name in ipairs(members[2]) do
  booleans[name] = ProtoField.bool(prefix .. "." .. name, name)
  extra["boolean_" .. name] = booleans[name]
end
dvl.fields = tables.make_fields(prefix, layouts.messages,
                                { ["pd4.velocity_mmps"] = "signed", ["pd4.checksum"] = "hex" }, extra)

local no_message = ProtoExpert.new(prefix .. ".no_message", "Bytes that belong to no message", expert.group.MALFORMED,
                                   expert.severity.WARN)
local bad_checksum = ProtoExpert.new(prefix .. ".bad_checksum", "Wrong checksum", expert.group.CHECKSUM,
                                     expert.severity.ERROR)
dvl.experts = { no_message, bad_checksum }

-- ---- Where messages begin and end

-- Bytes from a brace at `at` to its matching brace, outside of texts (1); 0: it is missing.
local function object_size(raw, at)
  local depth, place = 0, at
  while place <= #raw and place - at <= longest_object do
    local found = raw:find('[{}"]', place)
    if not found then
      return 0
    end
    local sign = raw:sub(found, found)
    place = found + 1
    if sign == '"' then
      repeat
        place = raw:find('["\\]', place)
        if not place then
          return 0
        end
        local escape = raw:sub(place, place) == "\\"
        place = place + (escape and 2 or 1)
      until not escape
    else
      depth = depth + (sign == "{" and 1 or -1)
      if depth == 0 then
        return found - at + 1
      end
    end
  end
  return place <= #raw and #raw - at + 1 or 0
end

-- The place after `count` lines; 0: the end of one is missing.
local function after_lines(raw, at, count)
  for _ = 1, count do
    local found = raw:find("\n", at, true)
    if not found then
      return 0
    end
    at = found + 1
  end
  return at
end

-- The kind of the message at `at` and its number of bytes, 0 if its end is missing. `whole`: no more bytes follow.
local function next_message(raw, at, whole)
  local first = raw:sub(at, at)
  if first == "{" then
    return "object", object_size(raw, at)
  end
  if first == ":" then
    local past = after_lines(raw, at, pd6_lines)
    return "pd6", past > 0 and past - at or 0
  end
  if raw:sub(at, at + 1) == pd4_start:sub(1, #raw - at + 1) then
    return "pd4", #raw - at + 1 >= pd4.size and pd4.size or 0
  end
  if first == "w" then
    local found = raw:find("[\r\n]", at)
    local past = found and raw:find("[^\r\n]", found) or found and #raw + 1
    if not past and whole then
      past = #raw + 1
    end
    return "sentence", past and past - at or 0
  end
  local following = raw:find("[{:w\125]", at + 1) or #raw + 1
  return raw:sub(at, following - 1):find("^%s*$") and "blanks" or "garbage", following - at
end

-- ---- Messages. Each function returns the name of the message, whether the device sent it, and a text for the info column.

local show = {}

function show.object(range, tree, text)
  tree:add(extra.text, range)
  for name, field in pairs(numbers) do
    local value = tonumber(text:match('[{,]%s*"' .. name .. '"%s*:%s*(%-?[%d.eE+-]+)') or "")
    if value then
      tree:add(field, range, value)
    end
  end
  for name, field in pairs(booleans) do
    local value = text:match('[{,]%s*"' .. name .. '"%s*:%s*(%l+)')
    if value then
      tree:add(field, range, value == "true")
    end
  end
  local answered = text:match('"response_to"%s*:%s*"([^"]*)"')
  if answered then
    tree:add(extra.response_to, range, answered)
    return "response", true, answered
  end
  local command = text:match('"command"%s*:%s*"([^"]*)"')
  if command then
    return command, false, ""
  end
  return text:match('"type"%s*:%s*"([^"]*)"') or "object", true, ""
end

function show.pd6(range, tree, text)
  local offset = 0
  for line, line_end in text:gmatch("([^\r\n]*)(\r?\n)") do
    tree:add(extra.text, range(offset, #line))
    offset = offset + #line + #line_end
  end
  return "pd6", true, ""
end

function show.pd4(range, tree)
  tables.add(tree, range:tvb(), pd4, 0)
  local sum = 0
  for i = 0, pd4.size - 3 do
    sum = sum + range:bytes():get_index(i)
  end
  if sum % 65536 ~= range(pd4.size - 2, 2):le_uint() then
    tree:add_proto_expert_info(bad_checksum)
  end
  return "pd4", true, ""
end

-- CRC-8 with the polynomial 0x07 (6).
local function crc8(text)
  local crc = 0
  for i = 1, #text do
    crc = bit.bxor(crc, text:byte(i))
    for _ = 1, 8 do
      local carried = crc >= 128
      crc = crc * 2 % 256
      if carried then
        crc = bit.bxor(crc, 7)
      end
    end
  end
  return crc
end

function show.sentence(range, tree, text)
  local line = text:match("^[^\r\n]*")
  tree:add(extra.text, range(0, #line))
  local body, checksum = line:match("^(.*)%*(%x%x)$")
  if body and crc8(body) ~= tonumber(checksum, 16) then
    tree:add_proto_expert_info(bad_checksum)
  end
  return "sentence", line:sub(1, 2) == "wr", line
end

local function add_message(kind, range, root)
  if kind == "blanks" then
    return nil
  end
  local tree = root:add(dvl, range)
  if kind == "garbage" then
    tree:append_text(", no message")
    tree:add(extra.garbage, range)
    tree:add_proto_expert_info(no_message)
    return "no message"
  end
  local name, from_head, more = show[kind](range, tree, range:raw())
  tree:add(extra.message, range, name):set_generated()
  tree:add(extra.from_head, range, from_head):set_generated()
  local text = more == "" and name or name .. ": " .. more
  tree:append_text(", " .. text)
  return text
end

function dvl.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "DVL_A50"
  local raw, texts, offset = tvb:raw(), {}, 0
  local stream = pinfo.port_type == 2  -- TCP
  while offset < #raw do
    local kind, size = next_message(raw, offset + 1, not stream)
    if size == 0 and stream then
      pinfo.desegment_offset = offset
      pinfo.desegment_len = DESEGMENT_ONE_MORE_SEGMENT
      break
    end
    if size == 0 then
      kind, size = "garbage", #raw - offset
    end
    table.insert(texts, add_message(kind, tvb(offset, size), root))
    offset = offset + size
  end
  if #texts > 0 then
    pinfo.cols.info = table.concat(texts, "; ")
  end
  return tvb:len()
end

-- ---- Ports

local in_use = { tcp = "16171,1037,1038", udp = "16171" }
dvl.prefs.tcp = Pref.range("TCP ports", in_use.tcp, "Ports of devices: JSON, PD6, PD4, serial lines", 65535)
dvl.prefs.udp = Pref.range("UDP ports", in_use.udp, "Ports of serial lines over UDP", 65535)
local function listen(transport, ports)
  local dissector_table = DissectorTable.get(transport .. ".port")
  if in_use[transport] ~= "" then
    dissector_table:remove(in_use[transport], dvl)
  end
  in_use[transport] = ports
  if ports ~= "" then
    dissector_table:add(ports, dvl)
  end
end
for transport, ports in pairs(in_use) do
  DissectorTable.get(transport .. ".port"):add(ports, dvl)
end
function dvl.prefs_changed()
  listen("tcp", dvl.prefs.tcp)
  listen("udp", dvl.prefs.udp)
end
