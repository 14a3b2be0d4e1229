// SPDX-License-Identifier: Apache-2.0
// A simulated daemon with two heads, to test the page alone: a fan and a scanning head with targets at the places in
// TARGETS. It serves the page's own files and sends frames only for credit, as the daemon does.
import { readFile } from "node:fs/promises";
import http from "node:http";
import path from "node:path";
import { WebSocketServer } from "ws";

/** By head: where its one strong echo is. */
export const TARGETS = [
  { range_m: 7.25, bearing_deg: -24 },
  { range_m: 5.4, bearing_deg: 112 },
];

const CSP = "default-src 'self'; img-src 'self' blob: data:; style-src 'self'";
const TYPES = { ".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml" };
const PING_MS = 70;
const BEAMS = 256;
const RANGE_M = 20;
const NATIVE_ROWS = 600;
const LINE_ROWS = 400;
const LINE_RANGE_M = 12;
const STEP_DEG = 1.8;
const RADIAN = Math.PI / 180;
// A grey pixel with alpha, for the pictures of the world.
const PIXEL = Buffer.from("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAQAAAC1HAwCAAAAC0lEQVR42mNgyAQAAEcAR5Ff29EAAAAASUVORK5CYII=", "base64");

/** Beams of a multibeam, evenly spaced in the sine of the bearing. */
const bearings = Float32Array.from({ length: BEAMS }, (_, beam) => Math.asin(Math.sin(60 * RADIAN) * ((2 * beam + 1) / BEAMS - 1)));

let seed = 1;
function random() {
  seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
  return seed / 2 ** 32;
}

/** The amplitude of a sloping bed with a wall on it, and the target. */
function echo(target, range_m, bearing_rad, cell_m) {
  const bearing_deg = bearing_rad / RADIAN;
  if (Math.abs(range_m - target.range_m) <= cell_m && Math.abs(bearing_deg - target.bearing_deg) < 1.5) {
    return 255;
  }
  const speckle = Math.sqrt(-Math.log(1 - random()));
  const wall = 13 / Math.cos(bearing_rad - 0.25);
  if (bearing_deg > 8 && bearing_deg < 41 && Math.abs(range_m - wall) < 0.25) {
    return Math.min(250, 130 * speckle);
  }
  const shadow = bearing_deg > 8 && bearing_deg < 41 && range_m > wall;
  const hidden = Math.abs(bearing_deg - target.bearing_deg) < 1.5 && range_m > target.range_m && range_m < target.range_m + 4;
  const bed = range_m < 4 || shadow || hidden ? 1.5 : 26 * Math.exp(-((range_m - 8) ** 2) / 60);
  return Math.min(60, bed * speckle);  // a brighter cell would look like the target and may be nearer
}

function message(header, directions, samples) {
  let text = JSON.stringify(header);
  text += " ".repeat((4 - (Buffer.byteLength(text) % 4)) % 4);
  const length = Buffer.alloc(4);
  length.writeUInt32LE(Buffer.byteLength(text));
  return Buffer.concat([length, Buffer.from(text), Buffer.from(directions.map((toStarboard) => -toStarboard).buffer), Buffer.from(samples.buffer)]);
}

function fanMessage(number, rows, age_s = 0) {
  const samples = new Uint8Array(rows * BEAMS);
  for (let row = 0, place = 0; row < rows; ++row) {
    for (let beam = 0; beam < BEAMS; ++beam, ++place) {
      samples[place] = echo(TARGETS[0], ((row + 0.5) * RANGE_M) / rows, bearings[beam], RANGE_M / rows / 2);
    }
  }
  return message({ type: "ping", head: 0, number, time_s: number / 10, age_s, beams: BEAMS, rows, bin_m: RANGE_M / rows, range_m: RANGE_M,
    sector_rad: 120 * RADIAN, scanning: false, bits: 8, pose: null }, bearings, samples);
}

function linesMessage(from, lines) {
  const directions = Float32Array.from({ length: lines }, (_, i) => {
    const bearing = ((from + i) * STEP_DEG + 180) % 360;
    return (bearing - 180) * RADIAN;
  });
  const samples = new Uint8Array(lines * LINE_ROWS);
  const cell_m = LINE_RANGE_M / LINE_ROWS;
  samples.forEach((_, i) => (samples[i] = 40 + 0.8 * echo(TARGETS[1], ((i % LINE_ROWS) + 0.5) * cell_m, directions[Math.floor(i / LINE_ROWS)], cell_m / 2)));
  return message({ type: "ping", head: 1, number: from + lines - 1, time_s: from / 10, age_s: 0, beams: 1, rows: LINE_ROWS, bin_m: cell_m, range_m: LINE_RANGE_M,
    sector_rad: 0, scanning: true, bits: 8, lines, pose: null }, directions, samples);
}

export const MOUNT = { position_m: [-2, -12, -9], orientation_wxyz: [0.766, 0, 0, 0.643] };

const WORLD = {
  name: "mock world", water_surface_z_m: 0, extent_m: { min: [-30, -30, -16], max: [30, 30, 2] },
  bodies: [
    { name: "seabed", moves: false, position_m: [0, 0, -15], orientation_wxyz: [1, 0, 0, 0], top: [[-30, -30], [30, -30], [30, 30], [-30, 30]], side: [[-30, 0], [30, 0]], triangles: 2, min_m: [-30, -30, -15], max_m: [30, 30, -15] },
    { name: "pier", moves: false, position_m: [2, 4, -8], orientation_wxyz: [0.966, 0, 0, 0.259], top: [[-8, -1], [8, -1], [8, 1], [-8, 1]], side: [[-8, -7], [8, -7], [8, 9], [-8, 9]], triangles: 12, min_m: [-6, -1, -15], max_m: [10, 9, 1] },
    { name: "door", moves: true, position_m: [-9, 1, -13], orientation_wxyz: [1, 0, 0, 0], top: [[-1, -1], [1, -1], [1, 1], [-1, 1]], side: [[-1, -1], [1, -1], [1, 1], [-1, 1]], triangles: 12, min_m: [-10, 0, -14], max_m: [-8, 2, -12] },
  ],
};

export class MockDaemon {
  constructor(page) {
    this.page = page;
    this.findings = [];
    this.poseFindings = [];
    this.recordingOn = false;
    this.token = null;  // if set, only viewers with this token may switch the recording
    this.wants = [0, 0];  // credit from viewers, by head
    this.statusWants = 0;
    this.worldAsked = 0;
    this.pings = 0;
    this.line = 0;
    this.sentLine = 0;
    this.idle = false;  // no ping is sent; the first viewer that asks gets the last ping
    this.last = null;  // frame of the first head that an idle daemon sends
    this.clients = [{ address: "127.0.0.1:52901", idle_s: 0.2, messages: 1234 }];  // of the first head
    this.vehicle = MOUNT;
  }

  /** Listens at a port of 127.0.0.1, one of the kernel's for 0. */
  async start(port = 0) {
    this.began = Date.now();
    this.server = http.createServer((request, response) => this.answer(request, response));
    this.sockets = new WebSocketServer({ server: this.server, path: "/api/live" });
    this.sockets.on("connection", (socket) => this.connected(socket));
    this.server.listen(port, "127.0.0.1");
    await new Promise((resolve, reject) => this.server.once("listening", resolve).once("error", reject));
    this.port = this.server.address().port;
    this.timer = setInterval(() => this.ping(), PING_MS);
  }

  async stop() {
    clearInterval(this.timer);
    for (const socket of this.sockets.clients) {
      socket.terminate();
    }
    this.server.closeAllConnections();
    await new Promise((resolve) => this.server.close(resolve));
  }

  async answer(request, response) {
    const { pathname } = new URL(request.url, "http://mock");
    if (pathname === "/api/recording") {
      this.switchRecording(request, response);
    } else if (pathname === "/api/world") {
      ++this.worldAsked;
      response.end(JSON.stringify(WORLD));
    } else if (pathname.startsWith("/api/world/")) {
      response.setHeader("Content-Type", "image/png").end(PIXEL);
    } else {
      await this.answerFile(pathname === "/" ? "/index.html" : pathname, response);
    }
  }

  async answerFile(name, response) {
    response.setHeader("Content-Security-Policy", CSP);
    try {
      const bytes = await readFile(path.join(this.page, path.basename(name)));
      response.setHeader("Content-Type", TYPES[path.extname(name)] ?? "text/plain");
      response.end(bytes);
    } catch {
      response.writeHead(404).end();
    }
  }

  switchRecording(request, response) {
    let body = "";
    request.on("data", (piece) => (body += piece));
    request.on("end", () => {
      if (this.token && request.headers.authorization !== `Bearer ${this.token}`) {
        response.writeHead(403).end();
        return;
      }
      this.recordingOn = JSON.parse(body).on;
      response.end(JSON.stringify({ on: this.recordingOn }));
    });
  }

  connected(socket) {
    socket.credit = new Map();
    socket.on("message", (data) => {
      const asked = JSON.parse(data);
      if (asked.type === "want") {
        ++this.wants[asked.head];
        if (this.last && !socket.credit.has(asked.head) && asked.head === 0) {
          socket.send(this.last);
        }
        socket.credit.set(asked.head, asked.max_rows);
      } else if (asked.type === "want_status") {
        ++this.statusWants;
        setTimeout(() => socket.send(JSON.stringify({ type: "status", status: this.status() })), socket.told ? 500 : 0);
        socket.told = true;
      }
    });
  }

  /** From now on no ping goes out. The last one, if there is one, is so old. */
  becomeIdle(age_s = null) {
    this.idle = true;
    this.last = age_s === null ? null : fanMessage(this.pings, NATIVE_ROWS, age_s);
  }

  ping() {
    if (this.idle) {
      return;
    }
    ++this.pings;
    this.line += 4;
    for (const socket of this.sockets.clients) {
      if (socket.credit.has(0)) {
        const most = socket.credit.get(0);
        socket.credit.delete(0);
        socket.send(fanMessage(this.pings, Math.ceil(NATIVE_ROWS / Math.ceil(NATIVE_ROWS / most))));
      }
      if (socket.credit.delete(1)) {
        const from = Math.max(socket.sentLine ?? this.line - 4, this.line - 200);
        socket.send(linesMessage(from, this.line - from));
        socket.sentLine = this.line;
      }
    }
  }

  head(name, type, more) {
    return {
      name, type, scanning: false, serves: ["udp 127.0.0.2:52900"], clients: [{ address: "127.0.0.1:52901", idle_s: 0.2, messages: 1234 }],
      pings: this.pings, pings_per_s: 14.3, render_ms: 47.8, latency_ms: 61, pose_age_ms: 12, pings_without_pose: 0,
      stages_ms: { visibility: 28, binning: 9.5, multipath: 3.1, azimuth_pattern: 2.2, pulse: 0.6, receiver: 4.4 },
      skipped: [{ rule: "unchanged_scene", count: 12, why: "Nothing moved since the last ping, so its mean echo is used again." }],
      counters: [{ name: "lines_resent", value: 3, client_fault: false }, { name: "wrong_id", value: 0, client_fault: true }], link_faults: null,
      settings: [{ name: "range", value: "20.00 m" }, { name: "sound_speed", value: "1491.2 m/s" }],
      range_m: RANGE_M, pose: MOUNT, aperture: { azimuth_rad: 120 * RADIAN, elevation_rad: 0.35 }, bearing_rad: 0, findings: [], ...more,
    };
  }

  status() {
    const bearing_rad = (((this.line * STEP_DEG + 180) % 360) - 180) * RADIAN;
    return {
      version: "1.9.0", configuration: "configs/two-heads.yaml", uptime_s: (Date.now() - this.began) / 1000, engine: "cpu, 8 threads",
      world: { name: "mock world", water_surface_z_m: 0 },
      heads: [
        this.head("bow", "multibeam", { findings: this.findings, clients: this.clients }),
        this.head("stern", "scanner", { scanning: true, serves: ["tcp 127.0.0.1:4001"], link_faults: "2 % loss, 10 ms delay", range_m: LINE_RANGE_M,
          aperture: { azimuth_rad: 0.05, elevation_rad: 0.6 }, bearing_rad: -bearing_rad, clients: [] }),
      ],
      poses: {
        inputs: [{ input: "pose stream udp 127.0.0.1:14600", publisher: "127.0.0.1:41234", poses: 4321, rate_hz: 50, age_s: 0.01, gaps: 0, jumps: 0, clock_restarts: 0, bad_messages: 0, refused: 0, findings: this.poseFindings }],
        vehicle: this.vehicle, bodies: [{ name: "door", position_m: [-9, 1.5, -13], orientation_wxyz: [1, 0, 0, 0] }],
      },
      recording: { directory: "recordings", on: this.recordingOn, bytes: 12345678, dropped: 0 },
    };
  }
}
