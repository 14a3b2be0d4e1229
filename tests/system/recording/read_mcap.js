// SPDX-License-Identifier: Apache-2.0
// Reads MCAP files with @mcap/core, decodes their messages by the descriptors in the files only, and prints the values
// that recording_test.py compares, as JSON.   node read_mcap.js FILE...
import { readFileSync } from "node:fs";
import { crc32 } from "node:zlib";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

// Some supported versions of Node lack zlib.crc32.
const table = Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; ++bit) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
  return n >>> 0;
});
const checksum = crc32 ?? ((bytes) => ~bytes.reduce((sum, byte) => table[(sum ^ byte) & 0xff] ^ (sum >>> 8), -1) >>> 0);

function decoder(schema) {
  const set = descriptor.FileDescriptorSet.decode(schema.data);
  const type = protobuf.Root.fromDescriptor(set).lookupType(schema.name);
  return (data) => type.toObject(type.decode(data), { defaults: true, longs: String, enums: String });
}

// protobufjs has several spellings of field names.
function plain(said) {
  return Object.fromEntries(Object.entries(said).map(([name, value]) => [name.replaceAll("_", "").toLowerCase(), value]));
}

function position(pose) {
  const { x, y, z } = plain(pose).positionm;
  return [x, y, z];
}

function summary(topic, schema, message, said) {
  const common = { topic, log_time: String(message.logTime), publish_time: String(message.publishTime) };
  switch (schema) {
    case "sonard.log.SonarImage":
      return { ...common, kind: "image", device_id: said.deviceid, number: said.pingnumber, lines: said.rangelines,
               beams: said.beams, crc32: checksum(said.pixels), size: said.pixels.length, bearings_rad: said.bearingsrad,
               transmit_ns: said.transmittimens, metres_per_line: said.metresperline, sound_speed_mps: said.soundspeedmps,
               gain_percent: said.gainpercent, vehicle: position(said.tworldvehicle), sonar: position(said.tworldsonar) };
    case "sonard.log.ScanLine":
      return { ...common, kind: "line", bearing_rad: said.bearingrad, bins: Buffer.from(said.bins).toString("hex"),
               bits: said.bitsperbin, device_id: said.deviceid, transmit_ns: said.transmittimens,
               wire_line: Buffer.from(said.wireline).toString("hex"), gain_percent: said.gainpercent, metres_per_bin: said.metresperbin, vehicle: position(said.tworldvehicle) };
    case "sonard.log.WireBytes":
      return { ...common, kind: "wire", to_client: said.direction === "DIRECTION_TO_CLIENT", transport: said.transport,
               peer: said.peer, crc32: checksum(said.data),
               data: said.transport === "TRANSPORT_UDP" ? "" : Buffer.from(said.data).toString("hex") };
    default:
      return { ...common, kind: "pose", vehicle: position(said.tworldvehicle), time: said.timens };
  }
}

async function read(path) {
  const file = readFileSync(path);
  const readable = {
    size: async () => BigInt(file.length),
    read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const decoders = new Map();
  const messages = [];
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!decoders.has(schema.id)) decoders.set(schema.id, decoder(schema));
    messages.push(summary(channel.topic, schema.name, message, plain(decoders.get(schema.id)(message.data))));
  }
  const stream = new McapStreamReader({ validateCrcs: true });
  stream.append(file);
  let streamed = 0;
  for (let record; (record = stream.nextRecord()); ) streamed += record.type === "Message";
  if (!stream.done() || streamed !== messages.length) throw new Error(`${path}: ${streamed} of ${messages.length} messages`);
  return { path, library: reader.header.library, messages };
}

const files = [];
for (const path of process.argv.slice(2)) files.push(await read(path));
process.stdout.write(JSON.stringify(files));
