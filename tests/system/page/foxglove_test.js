// SPDX-License-Identifier: Apache-2.0
// Foxglove's own client, from npm, on the page of a running daemon. Checks messages with Foxglove's own schemas, and the
// status with the schema that the daemon serves.
//   node foxglove_test.js PROGRAMS DATA     on a machine of its own, because it uses the default ports
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import schemas from "@foxglove/schemas/jsonschema.js";
import protocol from "@foxglove/ws-protocol";
import Ajv2020 from "ajv/dist/2020.js";
import { PNG } from "pngjs";
import { WebSocket } from "ws";
import { startProgram } from "./programs.js";

const { CompressedImage, FrameTransform, PointCloud } = schemas;
const { FoxgloveClient } = protocol;
const [programs, data] = process.argv.slice(2);
const ADDRESS = "127.0.0.1:8014";
const PATIENCE_MS = 60000;
const POSITION = [0.5, -1, 2]; // place of the vehicle; the sphere is at (3, 2, 0)
const HEADING = Math.PI / 3;

const CONFIG = `
engine: cpu
world: {file: ${path.join(data, "sphere_to_port.sdf")}}
poses: {initial: {position_m: [${POSITION}], rpy_deg: [0, 0, 60]}}
sampling: {preset: fast}
web: {bind: ${ADDRESS}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    mount: {position_m: [1, 0, 0]}
    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}
  - name: stern
    type: micron
    serial: {tcp: [{bind: 127.0.0.1:4001}]}
    timing: {line_period_ms: 10}
`;

const folder = mkdtempSync(path.join(tmpdir(), "sonard-foxglove-"));
const running = [];
// Foxglove's schemas write tuples as in an older draft.
const ajv = new Ajv2020({ strict: false, validateFormats: false });

const start = (name, ...options) => startProgram(path.join(programs, name), options, running);

/** Waits for what `take` returns, when it is something. */
async function until(what, take) {
  const end = Date.now() + PATIENCE_MS;
  for (;;) {
    const taken = await take();
    if (taken) return taken;
    assert.ok(Date.now() < end, `${what}: not after ${PATIENCE_MS} ms`);
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

/** A client with all channels that the daemon offers. */
async function connect(protocols = [FoxgloveClient.SUPPORTED_SUBPROTOCOL]) {
  const socket = new WebSocket(`ws://${ADDRESS}`, protocols);
  const client = new FoxgloveClient({ ws: socket });
  const seen = { channels: new Map(), messages: new Map(), problems: [], info: null };
  client.on("serverInfo", (info) => (seen.info = info));
  client.on("status", (status) => seen.problems.push(status.message));
  client.on("error", (error) => seen.problems.push(String(error)));
  client.on("advertise", (list) => list.forEach((channel) => seen.channels.set(channel.topic, channel)));
  client.on("message", ({ subscriptionId, data: bytes }) => {
    const list = seen.messages.get(subscriptionId) ?? [];
    list.push(JSON.parse(Buffer.from(bytes.buffer, bytes.byteOffset, bytes.byteLength).toString()));
    seen.messages.set(subscriptionId, list);
  });
  await until("the channels", () => seen.channels.size > 0);
  const subscribe = (topic) => client.subscribe(seen.channels.get(topic).id);
  const first = (id) => until(`a message of subscription ${id}`, () => seen.messages.get(id)?.at(-1));
  return { client, socket, seen, subscribe, first };
}

function expectValid(schema, message) {
  const validate = ajv.compile(schema);
  assert.ok(validate(message), ajv.errorsText(validate.errors));
}

before(async () => {
  writeFileSync(path.join(folder, "sonard.yaml"), CONFIG);
  const daemon = start("sonard", "run", path.join(folder, "sonard.yaml"));
  await until("the daemon to be ready", () => {
    assert.equal(daemon.exitCode, null, `the daemon ended: ${daemon.output}`);
    return daemon.output.includes("sonard ready");
  });
  start("sonarview", "--range", "10", "--continuous", "100", "--ping-wait", "0", "--client-address", "127.0.0.1", "--quiet");
  start("sonarview", "micron", "--tcp", "127.0.0.1:4001", "--range", "10", "--turns", "0", "--line-wait", "0", "--quiet");
});

after(() => {
  running.forEach((child) => child.kill("SIGKILL"));
  rmSync(folder, { recursive: true });
});

test("every channel is made known with its schema", async () => {
  const { client, seen } = await connect();
  assert.equal(seen.info.name, "sonard");
  assert.deepEqual([...seen.channels.keys()].sort(), ["/bow/echoes", "/bow/image", "/bow/transform", "/status", "/stern/echoes", "/stern/image", "/stern/transform"]);
  assert.equal(seen.channels.get("/bow/image").schemaName, "foxglove.CompressedImage");
  for (const { encoding, schema, schemaEncoding } of seen.channels.values()) {
    assert.deepEqual([encoding, schemaEncoding], ["json", "jsonschema"]);
    ajv.compile(JSON.parse(schema));
  }
  client.close();
});

// Clients before and after the protocol's new name, and those that speak to servers of both.
for (const protocols of [["foxglove.websocket.v1"], ["foxglove.sdk.v1"], ["foxglove.sdk.v1", "foxglove.websocket.v1"], ["other", "foxglove.websocket.v1"]]) {
  test(`a client that offers ${protocols.join(" and ")} gets messages`, async () => {
    const { client, socket, subscribe, first } = await connect(protocols);
    assert.equal(socket.protocol, protocols.find((name) => name.startsWith("foxglove.")));
    await first(subscribe("/bow/transform"));
    client.close();
  });
}

test("a client that offers no known protocol is told which there are", async () => {
  const socket = new WebSocket(`ws://${ADDRESS}`, ["foxglove.sdk.v9"]);
  const response = await new Promise((resolve) => socket.on("unexpected-response", (_, answer) => resolve(answer)));
  assert.equal(response.statusCode, 400);
  let body = "";
  for await (const chunk of response) body += chunk;
  assert.match(body, /Offer one of the protocols foxglove\.websocket\.v1, foxglove\.sdk\.v1/);
});

for (const head of ["bow", "stern"]) {
  test(`images of ${head} come, and show echoes`, async () => {
    const { client, seen, subscribe, first } = await connect();
    const topic = `/${head}/image`;
    const message = await first(subscribe(topic));
    expectValid(CompressedImage, message);
    expectValid(JSON.parse(seen.channels.get(topic).schema), message);
    assert.deepEqual([message.format, message.frame_id], ["png", head]);
    assert.ok(Math.abs(message.timestamp.sec - Date.now() / 1000) < 60, "stamps are those of the wall clock");
    const picture = PNG.sync.read(Buffer.from(message.data, "base64"));
    assert.ok(picture.width > 400 && picture.height > 300, `${picture.width} x ${picture.height}`);
    const bright = picture.data.filter((value, i) => i % 4 === 0 && value > 150).length;
    assert.ok(bright > 20, `${bright} bright pixels`);
    client.close();
  });
}

for (const [head, count] of [["bow", 256], ["stern", null]]) {
  test(`points of ${head} come`, async () => {
    const { client, seen, subscribe, first } = await connect();
    const topic = `/${head}/echoes`;
    const message = await first(subscribe(topic));
    expectValid(PointCloud, message);
    expectValid(JSON.parse(seen.channels.get(topic).schema), message);
    assert.deepEqual(message.fields.map(({ name, offset, type }) => [name, offset, type]),
      [["x", 0, 7], ["y", 4, 7], ["z", 8, 7], ["intensity", 12, 7]]);
    const data = Buffer.from(message.data, "base64");
    assert.equal(data.length % message.point_stride, 0);
    const points = data.length / message.point_stride;
    assert.ok(count === null ? points > 0 : points === count, `${points} points`);
    for (let i = 0; i < points; ++i) {
      const range = Math.hypot(data.readFloatLE(16 * i), data.readFloatLE(16 * i + 4), data.readFloatLE(16 * i + 8));
      assert.ok(range > 0 && range < 10.2, `${range} m`);
    }
    client.close();
  });
}

test("the transform is the pose that the vehicle was given, and the mount", async () => {
  const { client, subscribe, first } = await connect();
  const message = await first(subscribe("/bow/transform"));
  expectValid(FrameTransform, message);
  assert.deepEqual([message.parent_frame_id, message.child_frame_id], ["world", "bow"]);
  const expected = [POSITION[0] + Math.cos(HEADING), POSITION[1] + Math.sin(HEADING), POSITION[2]];
  const { translation: t, rotation: r } = message;
  [t.x, t.y, t.z].forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-9, `${value} ${expected[i]}`));
  const turn = [0, 0, Math.sin(HEADING / 2), Math.cos(HEADING / 2)];
  [r.x, r.y, r.z, r.w].forEach((value, i) => assert.ok(Math.abs(value - turn[i]) < 1e-9, `${value} ${turn[i]}`));
  client.close();
});

test("the status is as its schema says, here and by HTTP", async () => {
  const { client, seen, subscribe, first } = await connect();
  const schema = await (await fetch(`http://${ADDRESS}/status.schema.json`)).json();
  assert.deepEqual(JSON.parse(seen.channels.get("/status").schema), schema);
  const message = await first(subscribe("/status"));
  expectValid(schema, message);
  expectValid(schema, await (await fetch(`http://${ADDRESS}/api/status`)).json());
  assert.ok(message.heads[0].stages_ms.visibility >= 0);
  client.close();
});

test("messages end with the subscription", async () => {
  const { client, seen, subscribe, first } = await connect();
  const id = subscribe("/bow/transform");
  await first(id);
  client.unsubscribe(id);
  await new Promise((resolve) => setTimeout(resolve, 500));
  const count = seen.messages.get(id).length;
  await new Promise((resolve) => setTimeout(resolve, 500));
  assert.equal(seen.messages.get(id).length, count);
  client.close();
});

test("nonsense is answered, and harms nobody", async () => {
  const { socket, seen, subscribe, first } = await connect();
  for (const text of ["", "{", "[]", '{"op":7}', '{"op":"subscribe"}', '{"op":"subscribe","subscriptions":[{"id":"a"}]}',
    '{"op":"subscribe","subscriptions":[{"id":1,"channelId":99}]}', '{"op":"subscribe","subscriptions":[{"id":1e300,"channelId":-1}]}', '{"op":"unsubscribe","subscriptionIds":[-1]}', '{"op":"advertise"}']) {
    socket.send(text);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
  socket.send(Buffer.from([1, 2, 3, 255]));
  await until("complaints", () => seen.problems.some((text) => text.includes("Channel 99 does not exist")));
  await first(subscribe("/bow/transform"));
  socket.close();
});
