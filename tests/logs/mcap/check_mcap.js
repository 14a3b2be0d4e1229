// SPDX-License-Identifier: Apache-2.0
// Reads the files of write_mcap_example with both readers of @mcap/core, and decodes their messages by the descriptors
// in the file only.   node check_mcap.js WRITER finished|recovered|growing|zstd
// The expected values are written here independently of the writer.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

const [writer, kind] = process.argv.slice(2);
const file = execFileSync(writer, [kind]);
const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
const start = 1_700_000_000_000_000_000n;
const schemaNames = {
  "/bow/image": "sonard.log.SonarImage",
  "/stern/line": "sonard.log.ScanLine",
  "/bow/wire": "sonard.log.WireBytes",
  "/pose": "sonard.log.PoseUsed",
};

function decoder(schema) {
  assert.equal(schema.encoding, "protobuf");
  const set = descriptor.FileDescriptorSet.decode(schema.data);
  const type = protobuf.Root.fromDescriptor(set).lookupType(schema.name);
  return (data) => type.toObject(type.decode(data), { defaults: true, longs: String, enums: String });
}

function checkMessage(topic, ping, said, message) {
  const time = start + BigInt(ping) * 100_000_000n;
  assert.equal(message.publishTime, time);
  if (topic === "/bow/image") {
    assert.equal(said.head, "bow");
    assert.equal(said.deviceId ?? said.device_id, 601);
    assert.equal(said.beams, 3);
    assert.deepEqual([...said.pixels], Array.from({ length: 12 }, (_, i) => (ping * 12 + i) % 256));
    assert.deepEqual(said.bearingsRad ?? said.bearings_rad, [0.5, 0, -0.5]);
    const pose = Object.entries(said).find(([name]) => /^_?T_?World_?Sonar$/i.test(name))[1];
    assert.equal((pose.positionM ?? pose.position_m).x, ping + 0.25);
  } else if (topic === "/stern/line") {
    assert.deepEqual([...said.bins], [1, 2, 255]);
  } else if (topic === "/bow/wire") {
    assert.equal(said.direction, "DIRECTION_TO_CLIENT");
    assert.equal(said.peer, "192.168.2.10:52900");
    assert.equal(said.data.length, ping);
  } else {
    assert.equal(said.timeNs ?? said.time_ns, String(time));
    assert.equal(said.bodies[0].name, "door");
  }
}

// Checks messages, in the order of the reader, and returns their number by topic.
function checkAll(messages, channels, schemas) {
  const counts = {};
  for (const message of messages) {
    const channel = channels.get(message.channelId);
    const schema = schemas.get(channel.schemaId);
    assert.equal(schema.name, schemaNames[channel.topic]);
    const ping = (counts[channel.topic] = (counts[channel.topic] ?? -1) + 1);
    assert.equal(message.sequence, ping);
    checkMessage(channel.topic, ping, decoder(schema)(message.data), message);
  }
  return Object.fromEntries(Object.entries(counts).map(([topic, last]) => [topic, last + 1]));
}

async function readIndexed() {
  const readable = {
    size: async () => BigInt(file.length),
    read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert.equal(reader.header.library, "sonard tests");
  assert.ok(reader.chunkIndexes.length > 3);
  for (const chunk of reader.chunkIndexes) {
    assert.equal(chunk.compression, kind === "zstd" ? "zstd" : "");
    assert.equal(chunk.compressedSize < chunk.uncompressedSize, kind === "zstd");
  }
  const messages = [];
  for await (const message of reader.readMessages()) {
    messages.push(message);
  }
  for (let i = 1; i < messages.length; ++i) {
    assert.ok(messages[i - 1].logTime <= messages[i].logTime);
  }
  assert.equal(reader.statistics.messageCount, BigInt(messages.length));
  assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
  assert.equal(reader.statistics.messageStartTime, start);
  return checkAll(messages, reader.channelsById, reader.schemasById);
}

function readStream() {
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers });
  reader.append(file);
  const channels = new Map();
  const schemas = new Map();
  const messages = [];
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") messages.push(record);
  }
  assert.equal(reader.done(), kind !== "growing");
  return checkAll(messages, channels, schemas);
}

const streamed = readStream();
const indexed = kind === "growing" ? streamed : await readIndexed(); // the index is written last
assert.deepEqual(streamed, indexed);
const all = { "/pose": 20, "/bow/wire": 20, "/bow/image": 20, "/stern/line": 20 };
if (kind !== "recovered") {
  assert.deepEqual(indexed, all);
} else {
  const count = Object.values(indexed).reduce((sum, n) => sum + n, 0);
  assert.ok(count > 40 && count < 80, `${count} messages are left of 80`);
}
console.log(`${kind}: ${file.length} bytes`, indexed);
