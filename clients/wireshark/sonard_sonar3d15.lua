-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Wireshark dissector for the images of a Sonar 3D-15 over UDP. Wireshark itself shows its HTTP. Section numbers refer to
-- protocol/sonar3d15/README.md. Put all sonard_*.lua files into the folder for personal Lua plugins, or load this one:
--   tshark -X lua_script:sonard_sonar3d15.lua -r capture.pcapng
-- The preference of the protocol SONAR3D15 sets the ports.
local here = __DIR__ == "" and "" or __DIR__ .. "/"
local tables = dofile(here .. "sonard_tables.lua")
local layouts = dofile(here .. "sonard_sonar3d15_fields.lua")

local prefix = "sonar3d15_sonar"
local sonar = Proto(prefix, "Sonar 3D-15")
local header_size, checksum_size = 8, 4
local ids = layouts.reports

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  payload = ProtoField.bytes(prefix .. ".payload", "Payload"),
  checksum = ProtoField.uint32(prefix .. ".checksum", "CRC-32", base.HEX),
  sequence = ProtoField.uint32(prefix .. ".sequence_id", "Number of the shot"),
  width = ProtoField.uint32(prefix .. ".width", "Columns"),
  height = ProtoField.uint32(prefix .. ".height", "Rows"),
  range = ProtoField.float(prefix .. ".range_m", "Maximum range (m)"),
  speed = ProtoField.float(prefix .. ".speed_of_sound", "Speed of sound (m/s)"),
}
sonar.fields = tables.make_fields(prefix, layouts.messages, { ["packet.id"] = "hex" }, extra)

local malformed = ProtoExpert.new(prefix .. ".malformed", "Not a packet: id or length", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local unreadable = ProtoExpert.new(prefix .. ".unreadable", "The payload cannot be read", expert.group.MALFORMED,
                                   expert.severity.WARN)
sonar.experts = { malformed, unreadable }

-- ---- Snappy and Protobuf (1, 2). Both read a string from `at` and return the value and the place after it, or nil.

local function varint(text, at)
  local value, factor = 0, 1
  for _ = 1, 10 do
    local byte = text:byte(at)
    if not byte then
      return nil
    end
    at = at + 1
    value = value + (byte % 128) * factor
    factor = factor * 128
    if byte < 128 then
      return value, at
    end
  end
  return nil
end

local function little_endian(text, at, size)
  local value = 0
  for i = size - 1, 0, -1 do
    value = value * 256 + (text:byte(at + i) or 0)
  end
  return value
end

-- The first bytes of a block of Snappy: `most` are enough for the header of an image. Nil if it is broken.
local function unpack_start(block, most)
  local size, at = varint(block, 1)
  if not size then
    return nil
  end
  local out = ""
  while at <= #block and #out < most do
    local tag = block:byte(at)
    local kind, length = tag % 4, math.floor(tag / 4)
    at = at + 1
    if kind == 0 then
      local bytes = length >= 60 and length - 59 or 0
      length = (bytes > 0 and little_endian(block, at, bytes) or length) + 1
      at = at + bytes
      out = out .. block:sub(at, at + length - 1)
      at = at + length
    else
      local offset
      if kind == 1 then
        offset = math.floor(tag / 32) * 256 + (block:byte(at) or 0)
        length = length % 8 + 4
        at = at + 1
      else
        offset = little_endian(block, at, kind == 2 and 2 or 4)
        length = length + 1
        at = at + (kind == 2 and 2 or 4)
      end
      if offset == 0 or offset > #out then
        return nil
      end
      for _ = 1, length do
        out = out .. out:sub(-offset, -offset)
      end
    end
  end
  return out
end

-- The fields of a message until its end or the end of the text: { [number] = value }.
local function fields_of(text)
  local fields, at = {}, 1
  while at and at <= #text do
    local key
    key, at = varint(text, at)
    if not key then
      break
    end
    local number, wire = math.floor(key / 8), key % 8
    if wire == 0 then
      fields[number], at = varint(text, at)
    elseif wire == 5 then
      fields[number], at = text:sub(at, at + 3), at + 4
    elseif wire == 2 then
      local size
      size, at = varint(text, at)
      if not size then
        break
      end
      fields[number], at = text:sub(at, at + size - 1), at + size
    else
      break
    end
  end
  return fields
end

local function float_of(four)
  local bytes = ByteArray.new()
  bytes:set_size(4)
  for i = 0, 3 do
    bytes:set_index(i, four:byte(i + 1))
  end
  return bytes:tvb("float")(0, 4):le_float()
end

local enough = 256

local function add_message(tree, range, text)
  local any = fields_of(fields_of(text)[1] or "")
  local name = tostring(any[1] or ""):match("([%w_]+)$")
  if not name then
    tree:add_proto_expert_info(unreadable)
    return "not readable"
  end
  tree:add(extra.message, range, name):set_generated()
  local value = fields_of(any[2] or "")
  local first = name == "RangeImage" and 5 or name == "BitmapImageGreyscale8" and 6 or nil
  if not first then
    return name
  end
  local number = fields_of(value[1] or "")[2] or 0
  local width, height = value[first] or 0, value[first + 1] or 0
  tree:add(extra.sequence, range, number):set_generated()
  tree:add(extra.width, range, width):set_generated()
  tree:add(extra.height, range, height):set_generated()
  if type(value[2]) == "string" and #value[2] == 4 then
    tree:add(extra.speed, range, float_of(value[2])):set_generated()
  end
  if type(value[3]) == "string" and #value[3] == 4 then
    tree:add(extra.range, range, float_of(value[3])):set_generated()
  end
  return string.format("%s %d, %d x %d", name, number, width, height)
end

function sonar.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = "SONAR3D15"
  local tree = root:add(sonar, tvb())
  if tvb:len() < header_size + checksum_size or not ids[tvb(0, 4):le_uint()] or tvb(4, 4):le_uint() ~= tvb:len() then
    tree:add_proto_expert_info(malformed)
    pinfo.cols.info = "not a packet"
    return tvb:len()
  end
  tables.add(tree, tvb, layouts.messages.packet, 0)
  local payload = tvb(header_size, tvb:len() - header_size - checksum_size)
  tree:add(extra.payload, payload)
  tree:add_le(extra.checksum, tvb(tvb:len() - checksum_size, checksum_size))
  local bytes = payload:len() > 0 and tvb:raw(header_size, payload:len()) or ""
  local text = ids[tvb(0, 4):le_uint()] == "RIP2" and unpack_start(bytes, enough) or bytes
  pinfo.cols.info = add_message(tree, payload, text)
  tree:append_text(", " .. tostring(pinfo.cols.info))
  return tvb:len()
end

local in_use = "4747"
sonar.prefs.udp = Pref.range("UDP ports", in_use, "Ports that receive images", 65535)
function sonar.prefs_changed()
  local dissector_table = DissectorTable.get("udp.port")
  if in_use ~= "" then
    dissector_table:remove(in_use, sonar)
  end
  in_use = sonar.prefs.udp
  if in_use ~= "" then
    dissector_table:add(in_use, sonar)
  end
end
DissectorTable.get("udp.port"):add(in_use, sonar)
