// SPDX-License-Identifier: Apache-2.0
// The page of a running daemon with two heads, each with a client, and a publisher of poses.
//   node daemon_test.js PROGRAMS DATA SCHEMA     on a machine of its own, because it uses the default ports
// DATA is tests/data/system. The target's place follows from sphere_to_port.sdf there: a sphere of radius 0.5 m at
// (3, 2, 0). Wrong poses, and their findings in pier_and_hull.sdf, are in wrong_poses.json. SCHEMA is
// pose.proto.
import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, afterEach, before, test } from "node:test";
import { framesAdvance, head, open, readsTarget, savesPng, startBrowser, state, until } from "./browser.js";
import { PosePublisher } from "./pose_publisher.js";
import { startProgram } from "./programs.js";

const [programs, data, schema] = process.argv.slice(2);
const ADDRESS = "127.0.0.1:8014";
const RANGE_M = 10;
const TARGET = { range_m: Math.hypot(3, 2) - 0.5, bearing_deg: (Math.atan2(-2, 3) * 180) / Math.PI };
const READY_MS = 60000;

const config = ({ world = "sphere_to_port.sdf", vehicle_model, initial_m = [0, 0, 0] }) => `
engine: cpu
world: {file: ${path.join(data, world)}${vehicle_model ? `, vehicle_model: ${vehicle_model}` : ""}}
poses: {${initial_m ? `initial: {position_m: [${initial_m}]}, ` : ""}udp: {bind: 127.0.0.1:14600}}
web: {bind: ${ADDRESS}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}
  - name: stern
    type: micron
    serial: {tcp: [{bind: 127.0.0.1:4001}]}
    timing: {line_period_ms: 10}
`;

const folder = mkdtempSync(path.join(tmpdir(), "sonard-page-"));
let running = [];
let publishers = [];
let browser;
let page;

const start = (name, ...options) => startProgram(path.join(programs, name), options, running);

async function end(child, signal = "SIGKILL") {
  running = running.filter((one) => one !== child);
  if (child.exitCode === null && child.signalCode === null) {
    const ended = new Promise((resolve) => child.once("exit", resolve));
    child.kill(signal);
    await ended;
  }
}

async function startDaemon(options = {}) {
  writeFileSync(path.join(folder, "sonard.yaml"), config(options));
  const daemon = start("sonard", "run", path.join(folder, "sonard.yaml"));
  await until("the daemon to be ready", () => {
    assert.equal(daemon.exitCode, null, `the daemon ended: ${daemon.output}`);
    return daemon.output.includes("sonard ready");
  }, READY_MS);
  return daemon;
}

function startClients(range_m = RANGE_M) {
  return [
    start("sonarview", "--range", String(range_m), "--continuous", "100", "--ping-wait", "0", "--client-address", "127.0.0.1", "--quiet"),
    start("sonarview", "micron", "--tcp", "127.0.0.1:4001", "--range", String(range_m), "--turns", "0", "--line-wait", "0", "--quiet"),
  ];
}

/** A publisher that keeps the vehicle in one place. */
function publish(position_m, orientation_xyzw = [0, 0, 0, 1]) {
  const file = path.join(folder, `pose-${running.length}.csv`); // another publisher may still be reading its file
  const pose = [...position_m, ...orientation_xyzw].join(",");
  writeFileSync(file, `t,x,y,z,qx,qy,qz,qw\n0,${pose}\n600,${pose}\n`);
  return start("posecast", file, "--to", "127.0.0.1:14600");
}

/** A publisher in one place whose stamps are those of a clock of its own. */
function publishBy(ticks_per_s) {
  const publisher = new PosePublisher(schema, 14600, [0, 0, 0], ticks_per_s);
  publishers.push(publisher);
  return publisher;
}

async function openPage() {
  page = await open(browser, ADDRESS);
  await state(page, "live");
}

before(async () => {
  browser = await startBrowser();
});

afterEach(async () => {
  const complaints = page?.complaints ?? [];
  await page?.close();
  page = null;
  publishers.forEach((publisher) => publisher.close());
  publishers = [];
  await Promise.all(running.map((child) => end(child)));
  assert.deepEqual(complaints, []);
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true });
});
process.on("exit", () => running.forEach((child) => child.kill("SIGKILL")));

test("two heads are seen, a target is read off, a picture saved", async () => {
  await startDaemon();
  startClients();
  publish([0, 0, 0]);
  await openPage();
  await Promise.all([framesAdvance(page, 0), framesAdvance(page, 1)]);
  assert.deepEqual(await page.locator(".head h2").allTextContents(), ["bow", "stern"]);
  await until("the publisher", async () => /127\.0\.0\.1:\d+/.test(await page.locator("#pose-body td[data-label=Publisher]").first().textContent()));
  await until("the client", async () => /127\.0\.0\.1:\d+.*messages/.test(await head(page, 0).locator(".clients").textContent()));
  await head(page, 0).locator(".freeze").click();
  await readsTarget(page, 0, TARGET, RANGE_M);
  await savesPng(page, 0, 600, 400);
});

test("the world is drawn with what is in it", async () => {
  await startDaemon();
  await openPage();
  await page.locator("#world summary").click();
  await until("both views", async () => (await page.locator("#views canvas").count()) === 2);
  assert.match(await page.locator(".views-head").textContent(), /1 body/);
});

test("a daemon that is killed and started again is regained", async () => {
  const daemon = await startDaemon();
  startClients();
  await openPage();
  await framesAdvance(page, 0);
  await end(daemon);
  await state(page, "lost");
  await Promise.all(running.map((child) => end(child)));
  await startDaemon();
  startClients();
  await state(page, "live");
  await framesAdvance(page, 0);
});

test("each wrong pose is said to be one", async () => {
  await startDaemon({ world: "pier_and_hull.sdf" });
  startClients(20);
  await openPage();
  const findings = head(page, 0).locator(".findings");
  for (const pose of JSON.parse(readFileSync(path.join(data, "wrong_poses.json"), "utf-8"))) {
    const publisher = publish(pose.position_m, pose.orientation_xyzw);
    await says(findings, new RegExp(pose.says));
    await end(publisher);
  }
});

/** Waits until the findings of a head, or those of the poses, say something, and can be seen. */
async function says(findings, text) {
  await until(`'${text}' to be said`, async () => text.test(await findings.textContent()), 60000);
  assert.ok(await findings.isVisible());
}

test("the vehicle's own hull around a head is named", async () => {
  await startDaemon({ world: "pier_and_hull.sdf", vehicle_model: "rov", initial_m: [30, 0, -5] });
  startClients(20);
  await openPage();
  await says(head(page, 0).locator(".findings"), /inside the body 'rov', its own vehicle \(to hide it, set hides_vehicle: true/);
});

test("a pose that never came is missed", async () => {
  await startDaemon({ initial_m: null });
  startClients();
  await openPage();
  await says(head(page, 0).locator(".findings"), /No pose of the vehicle has arrived/);
});

test("two publishers are named", async () => {
  await startDaemon();
  publish([0, 0, 0]);
  publish([0, 0, 0]);
  await openPage();
  await says(page.locator("#pose-findings"), /2 publishers send poses at the same time/);
});

test("stamps in another unit are named", async () => {
  for (const [ticks_per_s, unit] of [[1e6, "microseconds"], [1e3, "milliseconds"], [1, "seconds"]]) {
    const daemon = await startDaemon();
    const publisher = publishBy(ticks_per_s);
    await openPage();
    await says(page.locator("#pose-findings"), new RegExp(`Stamps of poses look like ${unit}`));
    await page.close();
    publishers = [];
    publisher.close();
    await end(daemon);
  }
});

test("a clock that runs backwards is named", async () => {
  await startDaemon();
  const publisher = publishBy(1e9);
  await openPage();
  await until("the publisher", async () => /127\.0\.0\.1:\d+/.test(await page.locator("#pose-body td[data-label=Publisher]").first().textContent()));
  publisher.back_s = 100;
  await says(page.locator("#pose-findings"), /clock went back 1 time/);
});
