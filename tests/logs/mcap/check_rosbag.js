// SPDX-License-Identifier: Apache-2.0
// A bag of sonard_client.to_rosbag in the readers of Foxglove: prints each message, in the order of time, as a line of JSON.
//   node check_rosbag.js FILE.mcap
// Definitions are compared with the published ones, and checksums are checked.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { crc32 } from "@foxglove/crc";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { ros2humble } from "@foxglove/rosmsg-msgs-common";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const file = readFileSync(process.argv[2]);
const field = (type, name, more = {}) => ({ type, name, isComplex: false, isArray: false, ...more });
const list = { isArray: true };
const inside = { isComplex: true };
// As marine_acoustic_msgs publishes them, without their constants.
const published = {
  ...ros2humble,
  "marine_acoustic_msgs/PingInfo": { definitions: [field("float32", "frequency"), field("float32", "sound_speed"),
    field("float32", "tx_beamwidths", list), field("float32", "rx_beamwidths", list)] },
  "marine_acoustic_msgs/SonarImageData": { definitions: [field("bool", "is_bigendian"), field("uint32", "dtype"),
    field("uint32", "beam_count"), field("uint8", "data", list)] },
  "marine_acoustic_msgs/ProjectedSonarImage": { definitions: [field("std_msgs/Header", "header", inside),
    field("marine_acoustic_msgs/PingInfo", "ping_info", inside),
    field("geometry_msgs/Vector3", "beam_directions", { ...inside, ...list }), field("float32", "ranges", list),
    field("marine_acoustic_msgs/SonarImageData", "image", inside)] },
};

/** Types and names of the fields; the published times are a type of their own. */
function fields(definition) {
  return definition.definitions.filter((one) => !one.isConstant).map((one) => [
    { time: "builtin_interfaces/Time" }[one.type] ?? one.type, one.name, one.isArray ?? false]);
}

function compareWithPublished(definitions) {
  for (const definition of definitions) {
    const name = definition.name?.replace("/msg/", "/");
    if (name !== "builtin_interfaces/Time") {
      assert.ok(published[name], `${name} is published`);
      assert.deepEqual(fields(definition), fields(published[name]), name);
    }
  }
}

const stream = new McapStreamReader({ validateCrcs: true, includeChunks: true });
stream.append(file);
const records = {};
for (let record = stream.nextRecord(); record; record = stream.nextRecord()) {
  records[record.type] = (records[record.type] ?? 0) + 1;
}
assert.ok(stream.done());

const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(file.length),
    read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
  },
});
assert.equal(reader.header.profile, "ros2");
assert.notEqual(reader.footer.summaryCrc, 0);
assert.equal(reader.dataSectionCrc, crc32(file.subarray(0, Number(reader.footer.summaryStart) - 13)));
assert.equal(Number(reader.statistics.messageCount), records.Message);
assert.equal(reader.statistics.chunkCount, records.Chunk);
assert.equal(reader.chunkIndexes.length, records.Chunk);

const readers = {};
const counts = {};
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  assert.deepEqual([channel.messageEncoding, schema.encoding], ["cdr", "ros2msg"]);
  if (!readers[schema.name]) {
    const definitions = parse(new TextDecoder().decode(schema.data), { ros2: true });
    definitions[0].name ??= schema.name;
    compareWithPublished(definitions);
    readers[schema.name] = new MessageReader(definitions);
  }
  assert.equal(message.sequence, counts[channel.topic] ?? 0);
  counts[channel.topic] = message.sequence + 1;
  const said = readers[schema.name].readMessage(message.data);
  const plain = JSON.stringify(said, (_, value) => (ArrayBuffer.isView(value) ? [...value] : value));
  process.stdout.write(`{"topic": "${channel.topic}", "type": "${schema.name}", "time_ns": ${message.logTime}, "fields": ${plain}}\n`);
}
for (const [id, channel] of reader.channelsById) {
  assert.equal(Number(reader.statistics.channelMessageCounts.get(id)), counts[channel.topic], channel.topic);
}
