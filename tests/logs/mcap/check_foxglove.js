// SPDX-License-Identifier: Apache-2.0
// Foxglove's own view of an MCAP file, through the reader library that Foxglove uses.
//   node check_foxglove.js FILE.mcap HEAD...
// Schemas are compared, field by field, with Foxglove's published ones (@foxglove/schemas). The world is
// tests/data/system/sphere_to_port.sdf: a sphere of radius 0.5 m at (3, 2, 0), and the heads at the origin.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { McapIndexedReader } from "@mcap/core";
import protobuf from "protobufjs";
import descriptor from "protobufjs/ext/descriptor/index.js";

const { foxgloveMessageSchemas, foxgloveEnumSchemas, generateProto } = createRequire(import.meta.url)("@foxglove/schemas/internal");
const [path, ...heads] = process.argv.slice(2);
const file = readFileSync(path);
const SPHERE = { range_m: Math.hypot(3, 2) - 0.5, bearing_rad: Math.atan2(2, 3) };

/** The published type: names, numbers and types of its fields and of those inside. */
function published(name) {
  const root = new protobuf.Root();
  for (const schema of Object.values(foxgloveMessageSchemas)) {
    const enums = Object.values(foxgloveEnumSchemas).filter((one) => one.parentSchemaName === schema.name);
    protobuf.parse(generateProto(schema, enums).replace(/^import.*$/gm, ""), root, { keepCase: true });
  }
  for (const name of ["timestamp", "duration"]) {
    root.addJSON(protobuf.common.get(`google/protobuf/${name}.proto`).nested);
  }
  root.resolveAll();
  return root.lookupType(name);
}

function fieldsOf(type) {
  const fields = {};
  for (const field of type.fieldsArray) {
    field.resolve();
    const kind = field.resolvedType;
    const is = kind instanceof protobuf.Type ? fieldsOf(kind) : kind instanceof protobuf.Enum ? { ...kind.values } : field.type;
    fields[field.name] = { id: field.id, repeated: field.repeated, is };
  }
  return fields;
}

const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(file.length),
    read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
  },
});
const seen = {};
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  const schema = reader.schemasById.get(channel.schemaId);
  if (!schema.name.startsWith("foxglove.")) {
    continue;
  }
  const type = protobuf.Root.fromDescriptor(descriptor.FileDescriptorSet.decode(schema.data)).lookupType(schema.name);
  if (!seen[channel.topic]) {
    assert.deepEqual(fieldsOf(type), fieldsOf(published(schema.name)), schema.name);
    seen[channel.topic] = [];
  }
  seen[channel.topic].push(type.toObject(type.decode(message.data), { defaults: true, longs: String, enums: String }));
}

/** [range, bearing] of the point with the greatest intensity. */
function strongest(cloud) {
  const stride = cloud.point_stride;
  assert.equal(stride, 16);
  assert.deepEqual(cloud.fields.map((one) => [one.name, one.offset, one.type]),
                   ["x", "y", "z", "intensity"].map((name, i) => [name, 4 * i, "FLOAT32"]));
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.length);
  let best = [-1];
  for (let at = 0; at + stride <= view.byteLength; at += stride) {
    const [x, y, , intensity] = [0, 4, 8, 12].map((offset) => view.getFloat32(at + offset, true));
    if (intensity > best[0]) {
      best = [intensity, Math.hypot(x, y), Math.atan2(y, x)];
    }
  }
  return best;
}

for (const head of heads) {
  const pictures = seen[`/${head}/picture`];
  assert.ok(pictures?.length > 0, `pictures of ${head}`);
  assert.equal(pictures[0].format, "jpeg");
  assert.deepEqual([...pictures[0].data.slice(0, 3)], [0xff, 0xd8, 0xff]);
  const transforms = seen[`/${head}/transform`];
  assert.ok(transforms?.length > 0, `transforms of ${head}`);
  assert.equal(transforms[0].parent_frame_id, "world");
  assert.equal(transforms[0].child_frame_id, head);
  assert.deepEqual(transforms[0].rotation, { x: 0, y: 0, z: 0, w: 1 });
  assert.ok(Math.abs(Date.now() / 1000 - Number(transforms[0].timestamp.seconds)) < 600);
  const [, range_m, bearing_rad] = seen[`/${head}/echoes`].map(strongest).reduce((a, b) => (b[0] > a[0] ? b : a));
  assert.ok(Math.abs(range_m - SPHERE.range_m) < 0.1, `${head}: ${range_m} m`);
  assert.ok(Math.abs(bearing_rad - SPHERE.bearing_rad) < 0.16, `${head}: ${bearing_rad} rad`);
}
console.log(Object.fromEntries(Object.entries(seen).map(([topic, messages]) => [topic, messages.length])));
