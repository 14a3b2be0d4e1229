-- SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-or-later
-- The dissector of any device of the Ping protocol: frames over UDP or TCP, in both directions, and the messages that
-- all devices have. Section numbers refer to protocol/ping360/README.md. Each dissector loads this file for itself and
-- calls it with a table `device`:
--   name, title      NAME_SONAR is the protocol; its title for people
--   tables, layouts  what sonard_tables.lua and sonard_NAME_fields.lua return
--   with_data        names of the messages that end with a count and as many bytes
--   asked_by_empty   set of the messages that an empty message with their number requests, in an older spelling (2.1)
--   least_own_id     messages with smaller numbers do not show which device a stream belongs to
--   extra            more fields
-- This file adds `proto`, `between_frames`, and the functions below. `device.details` has a function for the part of each message
-- beyond its table. It gets one frame without its checksum, with all bytes of its table, and returns a text for the info
-- column, or nil.
local device = ...
if type(device) ~= "table" then
  return  -- Wireshark loads every file of its folder of plugins
end

local tables, layouts, details = device.tables, device.layouts, {}
local prefix = device.name .. "_sonar"
local proto = Proto(prefix, device.title)
local header_size = 8
local checksum_size = 2
local overhead = header_size + checksum_size
local length_end = 4  -- of the bytes that give the length of a frame
local max_payload_size = 4096  -- 1.1
local give_up_s = 0.1  -- an incomplete frame is dropped after this time without bytes (1.1)

local messages = layouts.messages
messages.frame = {
  minimum = header_size,
  fields = { { 2, 2, "payload_length" }, { 4, 2, "message_id" }, { 6, 1, "source" }, { 7, 1, "destination" } },
}
-- Messages with a rest: data after a table and their count (2.2), texts after a table or alone (2.1).
local has_rest = { nack = true, ascii_text = true }
for _, name in ipairs(device.with_data) do
  local layout = messages[name]
  table.insert(layout.fields, { layout.size, 2, "data_length" })
  layout.size = layout.size + 2
  layout.minimum = layout.size
  has_rest[name] = true
end

local extra = {
  message = ProtoField.string(prefix .. ".message", "Message"),
  from_head = ProtoField.bool(prefix .. ".from_head", "From the head"),
  checksum = ProtoField.uint16(prefix .. ".checksum", "Checksum", base.HEX),
  about = ProtoField.string(prefix .. ".about", "Subject message"),
  text = ProtoField.string(prefix .. ".text", "Text"),
  data = ProtoField.bytes(prefix .. ".data", "Data"),
  garbage = ProtoField.bytes(prefix .. ".garbage", "Bytes outside frames"),
  piece = ProtoField.bytes(prefix .. ".piece", "Piece of a frame"),
  begun_in = ProtoField.framenum(prefix .. ".begun_in", "The first frame began in"),
}
for name, field in pairs(device.extra or {}) do
  extra[name] = field
end
proto.fields = tables.make_fields(prefix, messages, {}, extra)

local bad_checksum = ProtoExpert.new(prefix .. ".bad_checksum", "Wrong checksum: receivers drop this frame",
                                     expert.group.CHECKSUM, expert.severity.ERROR)
local malformed = ProtoExpert.new(prefix .. ".malformed", "Shorter than its message", expert.group.MALFORMED,
                                  expert.severity.ERROR)
local too_long = ProtoExpert.new(prefix .. ".too_long", "Longer than its message", expert.group.PROTOCOL,
                                 expert.severity.NOTE)
local no_frame = ProtoExpert.new(prefix .. ".no_frame", "Bytes that belong to no frame", expert.group.MALFORMED,
                                 expert.severity.WARN)
local between_frames = ProtoExpert.new(prefix .. ".between_frames", "Known bytes between frames",
                                       expert.group.SEQUENCE, expert.severity.NOTE)
local unfinished_frame = ProtoExpert.new(prefix .. ".unfinished", "A frame before this packet was never finished",
                                         expert.group.SEQUENCE, expert.severity.WARN)
local unknown = ProtoExpert.new(prefix .. ".unknown_id", "Message not in the protocol description",
                                expert.group.UNDECODED, expert.severity.NOTE)
proto.experts = { bad_checksum, malformed, too_long, no_frame, between_frames, unfinished_frame, unknown }

device.proto, device.details, device.between_frames = proto, details, between_frames

-- ---- Where frames begin and end (1.1)

-- The bytes of `tvb`, with the sum of the bytes before each offset, so that each checksum is a difference.
local function make_stream(tvb)
  local stream = { tvb = tvb, raw = tvb:raw(), sums = { [0] = 0 } }
  for i = 1, #stream.raw do
    stream.sums[i] = stream.sums[i - 1] + stream.raw:byte(i)
  end
  return stream
end

local function u16(raw, offset)
  local low, high = raw:byte(offset + 1, offset + 2)
  return low + 256 * high
end

-- Size of the frame that may begin at `offset`; 0 if too few bytes are there to give it, nil if no frame begins.
local function stated_size(raw, offset)
  local front = raw:sub(offset + 1, offset + length_end)
  if front == "" or front:sub(1, 2) ~= ("BR"):sub(1, #front) then
    return nil
  end
  if #front < length_end then
    return 0
  end
  local length = u16(raw, offset + 2)
  return length <= max_payload_size and length + overhead or nil
end

local function sum_of(stream, offset, size)
  return (stream.sums[offset + size - checksum_size] - stream.sums[offset]) % 65536
end

-- Whether a complete frame with a correct checksum is at `offset`.
local function is_right(stream, offset)
  local size = stated_size(stream.raw, offset)
  return size ~= nil and size > 0 and offset + size <= #stream.raw and
         sum_of(stream, offset, size) == u16(stream.raw, offset + size - checksum_size)
end

local function payload_size(layout)
  return layout and layout.size - header_size or 0
end

-- Whether a payload of `length` bytes fits one of the messages with this number.
local function fits(id, length)
  local command, report = layouts.commands[id], layouts.reports[id]
  if command and length == payload_size(messages[command]) then
    return true
  end
  local least = payload_size(messages[report])
  return report ~= nil and
         (length == least or (length == 0 and device.asked_by_empty[report]) or (length > least and has_rest[report])) or false
end

-- Whether the bytes at `offset` look like a frame of this protocol, complete or not.
local function is_plausible(raw, offset)
  local size = stated_size(raw, offset)
  local id = size and size > 0 and offset + 6 <= #raw and u16(raw, offset + 4)
  return id and id >= device.least_own_id and fits(id, size - overhead) or false
end

-- Bytes of a frame with a wrong checksum before the next frame; all its bytes if no frame begins inside.
local function bytes_of_broken_frame(stream, offset, size)
  local inside = offset + 1
  while true do
    inside = (stream.raw:find("BR", inside + 1, true) or #stream.raw + 1) - 1
    if inside >= offset + size then
      return size
    end
    local whole = inside + (stated_size(stream.raw, inside) or 0) <= #stream.raw
    if is_right(stream, inside) or (not whole and is_plausible(stream.raw, inside)) then
      return inside - offset
    end
    inside = inside + 1
  end
end

-- The kind of the bytes at `offset` ("frame", "garbage" or "more") and their number. For "more", the number is the
-- count of missing bytes, 0 if not known yet.
local function next_piece(stream, offset)
  local raw = stream.raw
  local left = #raw - offset
  local size = stated_size(raw, offset)
  if size and left < math.max(size, length_end) then
    return "more", math.max(size - left, 0)
  end
  if size then
    local bytes = is_right(stream, offset) and size or bytes_of_broken_frame(stream, offset, size)
    return bytes == size and "frame" or "garbage", bytes
  end
  local following = offset
  repeat
    following = (raw:find("B", following + 2, true) or #raw + 1) - 1
  until following >= #raw or stated_size(raw, following)
  return "garbage", following - offset
end

-- ---- The parts of common messages beyond their tables.

local function name_of(id)
  return layouts.commands[id] or layouts.reports[id] or string.format("message %d", id)
end

-- Adds the message that another one is about. Returns its name.
function device.add_about(tvb, tree)
  local name = name_of(tvb(8, 2):le_uint())
  tree:add(extra.about, tvb(8, 2), name):set_generated()
  return name
end

local function add_text(tvb, tree, offset)
  if tvb:len() == offset then
    return ""
  end
  tree:add_packet_field(extra.text, tvb(offset), ENC_ASCII)
  return '"' .. tvb:raw(offset, tvb:len() - offset):gsub("[^\32-\126]", "?") .. '"'
end

-- Adds the bytes after the count at the end of a table. Returns their declared number.
function device.add_data(tvb, tree, layout)
  local count, there = tvb(layout.size - 2, 2):le_uint(), tvb:len() - layout.size
  if there ~= count then
    tree:add_proto_expert_info(there < count and malformed or too_long,
                               string.format("%d bytes of data declared, %d present", count, there))
  end
  if math.min(there, count) > 0 then
    tree:add(extra.data, tvb(layout.size, math.min(there, count)))
  end
  return count
end

details.general_request = device.add_about
details.ack = device.add_about

function details.nack(tvb, tree)
  return device.add_about(tvb, tree) .. ", " .. add_text(tvb, tree, messages.nack.size)
end

function details.ascii_text(tvb, tree)
  return add_text(tvb, tree, header_size)
end

-- ---- Frames

local function is_older_request(id, length)
  return length == 0 and device.asked_by_empty[layouts.reports[id]]
end

-- Whether a head sent the frame. Most messages exist in one direction only; for others the sender's number decides.
local function is_from_head(id, length, source)
  local command, report = layouts.commands[id], layouts.reports[id]
  if (command == nil) == (report == nil) then
    return source ~= 0
  end
  return report ~= nil and not is_older_request(id, length)
end

-- Adds a message: with a table of its own, or without one if it has no fields.
local function add_message(tvb, tree, name)
  local layout = messages[name]
  if layout and not tables.add(tree, tvb, layout, 0) then
    tree:add_proto_expert_info(malformed)
    return nil
  end
  if not has_rest[name] and tvb:len() > header_size + payload_size(layout) then
    tree:add_proto_expert_info(too_long)
  end
  return details[name] and details[name](tvb, tree)
end

local function dissect_frame(stream, offset, size, root)
  local tvb = stream.tvb(offset, size):tvb()
  local tree = root:add(proto, tvb())
  local body = tvb(0, size - checksum_size):tvb()
  tables.add(tree, body, messages.frame, 0)
  local length, id, source = tvb(2, 2):le_uint(), tvb(4, 2):le_uint(), tvb(6, 1):uint()
  local from_head = is_from_head(id, length, source)
  tree:add(extra.from_head, tvb(4, 2), from_head):set_generated()

  local asked = is_older_request(id, length) and layouts.reports[id]
  local name = asked and "general_request" or (from_head and layouts.reports or layouts.commands)[id]
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
  if not is_right(stream, offset) then
    checksum:add_proto_expert_info(bad_checksum, string.format("Wrong checksum: the sum is 0x%04x",
                                                               sum_of(stream, offset, size)))
    text = text .. ", wrong checksum"
  end
  tree:append_text(", " .. text)
  return text
end

-- Bytes that clients send outside frames (1.1, 4.4).
local function known_garbage(raw)
  if raw == "\0\255" then
    return "00 FF, as ping-cpp sends it when it opens UDP"
  end
  return raw:match("^U+%z?$") and "Bytes from which a serial head finds the speed of its line"
end

local function add_garbage(range, root)
  local tree = root:add(proto, range)
  tree:append_text(", no frame")
  tree:add(extra.garbage, range)
  local known = known_garbage(range:raw())
  if known then
    tree:add_proto_expert_info(between_frames, known)
  else
    tree:add_proto_expert_info(no_frame)
  end
  return "no frame"
end

-- Dissects a stream up to its end or an incomplete frame. Returns the offset of that frame, and the number of its
-- missing bytes as next_piece() returns it.
local function dissect_stream(stream, root, texts)
  local offset = 0
  while offset < #stream.raw do
    local kind, size = next_piece(stream, offset)
    if kind == "more" then
      return offset, size
    end
    if kind == "frame" then
      table.insert(texts, dissect_frame(stream, offset, size, root))
    else
      table.insert(texts, add_garbage(stream.tvb(offset, size), root))
    end
    offset = offset + size
  end
  return offset, 0
end

-- ---- UDP: datagrams may cut frames anywhere (4.1, 4.2). Wireshark reassembles TCP only.

-- unfinished: by both ends, the incomplete frame of a datagram: { bytes, number of the packet where it began, time }.
-- continued, given_up: by packet, the frame that it continues, or the one that was dropped when it came. Filled in the
-- first pass over a capture.
local unfinished, continued, given_up = {}, {}, {}
-- By both ends, the first packet that was dissected as this protocol.
local first_packet = {}
function proto.init()
  unfinished, continued, given_up, first_packet = {}, {}, {}, {}
end

local function ends_of(pinfo)
  local source, destination = tostring(pinfo.src) .. " " .. pinfo.src_port, tostring(pinfo.dst) .. " " .. pinfo.dst_port
  return source .. " " .. destination, destination .. " " .. source
end

-- A datagram that begins with a complete frame does not continue an earlier one.
local function note_beginning(stream, pinfo, direction)
  local before = unfinished[direction]
  unfinished[direction] = nil
  if before then
    local in_time = pinfo.rel_ts - before.time < give_up_s
    local place = in_time and not is_right(stream, 0) and continued or given_up
    place[pinfo.number] = before
  end
end

local function note_end(stream, offset, pinfo, direction, before)
  unfinished[direction] = {
    bytes = stream.raw:sub(offset + 1),
    number = before and offset == 0 and before.number or pinfo.number,
    time = pinfo.rel_ts,
  }
end

-- Adds a line for `range`, and returns it.
function device.add_note(range, root, text)
  local tree = root:add(proto, range)
  tree:append_text(", " .. text)
  return tree
end

local function add_beginning(tvb, pinfo, root)
  local before, lost = continued[pinfo.number], given_up[pinfo.number]
  if before then
    device.add_note(tvb(), root, "continues a frame"):add(extra.begun_in, before.number):set_generated()
  end
  if lost then
    device.add_note(tvb(), root, "starts a new frame"):add_proto_expert_info(
      unfinished_frame, string.format("%d bytes from packet %d on were never completed to a frame", #lost.bytes, lost.number))
  end
end

local function dissect_datagram(tvb, pinfo, root, texts)
  local direction, back = ends_of(pinfo)
  local stream = make_stream(tvb)
  if not pinfo.visited then
    note_beginning(stream, pinfo, direction)
    first_packet[direction] = first_packet[direction] or pinfo.number
    first_packet[back] = first_packet[direction]
  end
  add_beginning(tvb, pinfo, root)
  local before = continued[pinfo.number]
  if before then
    local whole = ByteArray.new(before.bytes, true)
    whole:append(tvb:bytes())
    stream = make_stream(whole:tvb(device.name:upper() .. " stream"))
  end
  local offset = dissect_stream(stream, root, texts)
  if offset < #stream.raw then
    local piece = tvb(math.max(offset - (before and #before.bytes or 0), 0))
    device.add_note(piece, root, "piece of a frame"):add(extra.piece, piece)
    table.insert(texts, "piece of a frame")
    if not pinfo.visited and tvb:reported_len() == tvb:len() then
      note_end(stream, offset, pinfo, direction, before)
    end
  end
end

function proto.dissector(tvb, pinfo, root)
  pinfo.cols.protocol = device.name:upper()
  pinfo.conversation = proto
  local texts = {}
  -- Wireshark calls this for TCP and UDP ports; the type of the port shows which.
  if pinfo.port_type == 2 then
    local offset, missing = dissect_stream(make_stream(tvb), root, texts)
    if offset < tvb:len() then
      pinfo.desegment_offset = offset
      pinfo.desegment_len = missing > 0 and missing or DESEGMENT_ONE_MORE_SEGMENT
    end
  else
    dissect_datagram(tvb, pinfo, root, texts)
  end
  if #texts > 0 then
    pinfo.cols.info = table.concat(texts, "; ")
  end
  return tvb:len()
end

-- Whether an earlier packet between the ends of this one was dissected as this protocol.
function device.knows_ends(pinfo)
  local known_from = first_packet[ends_of(pinfo)]
  return known_from and known_from < pinfo.number
end

-- ---- Ports. Serial lines, and streams over TCP, are found by the start of their frames.

-- Registers `proto` for the ports, with a preference for each transport. Returns the ports in use, by transport.
function device.listen(proto, ports, description)
  local in_use, dissector_tables = {}, {}
  for transport, default in pairs(ports) do
    in_use[transport] = default
    dissector_tables[transport] = DissectorTable.get(transport .. ".port")
    proto.prefs[transport] = Pref.range(transport:upper() .. " ports", default, description, 65535)
  end
  local function add()
    for transport, dissector_table in pairs(dissector_tables) do
      if in_use[transport] ~= "" then
        dissector_table:add(in_use[transport], proto)
      end
    end
  end
  add()
  function proto.prefs_changed()
    for transport, dissector_table in pairs(dissector_tables) do
      if in_use[transport] ~= "" then
        dissector_table:remove(in_use[transport], proto)
      end
      in_use[transport] = proto.prefs[transport]
    end
    add()
  end
  return in_use
end
for _, transport in ipairs({ "tcp", "udp" }) do
  proto:register_heuristic(transport, function(tvb, pinfo, root)
    if tvb:len() < header_size or not is_plausible(tvb:raw(0, header_size), 0) then
      return false
    end
    proto.dissector(tvb, pinfo, root)
    return true
  end)
end
