-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- Code that all dissectors share: makes Wireshark fields from a table of fields, and shows a message by it. The tables
-- (sonard_DEVICE_fields.lua) describe the layout of each message. Each dissector loads this file itself.
local tables = {}

-- Longer runs of bytes are shown as one value.
local most_values = 8

local signed_integers = { [1] = ProtoField.int8, [2] = ProtoField.int16, [4] = ProtoField.int32, [8] = ProtoField.int64 }
local integers = { [1] = ProtoField.uint8, [2] = ProtoField.uint16, [4] = ProtoField.uint32, [8] = ProtoField.uint64 }

-- Makes the Wireshark field for one entry. `format`: "hex", "ipv4", "double", "signed", or nil for decimal.
local function make_field(abbreviation, entry, format)
  local size, name, count = entry[2], entry[3], entry[4] or 1
  if not integers[size] or (size == 1 and count > most_values) then
    return ProtoField.bytes(abbreviation, name)
  end
  if format == "ipv4" then
    return ProtoField.ipv4(abbreviation, name)
  end
  if format == "double" then
    return ProtoField.double(abbreviation, name)
  end
  if format == "signed" then
    return signed_integers[size](abbreviation, name)
  end
  return integers[size](abbreviation, name, format == "hex" and base.HEX or base.DEC)
end

-- Makes the fields of all `messages`, PREFIX.MESSAGE.NAME. Returns them and the fields of `extra` in one list for the
-- protocol. The keys of `formats` are "MESSAGE.NAME".
function tables.make_fields(prefix, messages, formats, extra)
  local fields = {}
  for _, field in pairs(extra) do
    table.insert(fields, field)
  end
  for message, layout in pairs(messages) do
    layout.proto_fields = {}
    for i, entry in ipairs(layout.fields) do
      local key = message .. "." .. entry[3]
      layout.proto_fields[i] = make_field(prefix .. "." .. key, entry, formats[key])
      table.insert(fields, layout.proto_fields[i])
    end
  end
  return fields
end

-- Adds the fields of `layout` in `tvb` to `tree`; offsets count from `base`. Fields beyond layout.minimum may be
-- missing. Returns false if an earlier field is missing.
function tables.add(tree, tvb, layout, base)
  for i, entry in ipairs(layout.fields) do
    local offset, size, count = base + entry[1], entry[2], entry[4] or 1
    if offset + size * count > tvb:len() then
      return entry[1] >= layout.minimum
    end
    local field = layout.proto_fields[i]
    if not integers[size] or (size == 1 and count > most_values) then
      tree:add(field, tvb(offset, size * count))
    else
      for k = 0, count - 1 do
        tree:add_le(field, tvb(offset + k * size, size))
      end
    end
  end
  return tvb:len() - base >= layout.minimum
end

-- Whether bit number `bit` of `value` is set.
function tables.has_bit(value, bit)
  return math.floor(value / 2 ^ bit) % 2 == 1
end

-- Dissectors of devices on serial lines, which share their ports; each has `begins_with_frame(tvb)` and `proto`. The
-- list is global, because each dissector loads this file for itself.
sonard_serial_devices = sonard_serial_devices or {}
tables.serial_devices = sonard_serial_devices

return tables
