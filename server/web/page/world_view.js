// SPDX-License-Identifier: Apache-2.0
// The world from above or from the side, with vehicle, fans and names.
import { make } from "./dom.js";
import { ringStep } from "./grid.js";
import { place, towards } from "./pose.js";
import { number } from "./text.js";

const MARGIN = { left: 40, right: 14, top: 12, bottom: 24 };
const ARC_STEPS = 24;
const GROUND_ALPHA = 0.42;  // names and fans must stand out from it
const LEAST_STEP_PX = 60;  // between lines of the grid
const THINNEST_RAD = 0.03;
const COLOUR = {
  grid: "rgba(140, 170, 200, 0.13)", axis: "#7d8b99", still: "rgba(150, 172, 194, 0.6)", moving: "#8fc7d8",
  name: "#c9d3dd", halo: "rgba(8, 11, 16, 0.9)", fan: "rgba(229, 165, 82, 0.2)", edge: "rgba(229, 165, 82, 0.8)",
  vehicle: "#ffe2b4", water: "rgba(96, 168, 208, 0.7)",
};

/** Points of the sector that a head ensonifies, in the world: level (from above) or upright (from the side). */
function footprint(head, upright) {
  const { azimuth_rad, elevation_rad } = head.aperture;
  const half = Math.max(THINNEST_RAD, upright ? elevation_rad : azimuth_rad) / 2;
  const ahead = head.scanning ? -head.bearing_rad : 0;  // the status counts to port
  const points = [head.pose.position_m];
  for (let step = 0; step <= ARC_STEPS; ++step) {
    const angle = half * ((2 * step) / ARC_STEPS - 1);
    points.push(place(head.pose, upright ? towards(head.range_m, ahead, angle) : towards(head.range_m, ahead + angle, 0)));
  }
  return points;
}

/** One of the two views. `axes`: which of x, y and z go to the right and up. */
export class WorldView {
  constructor(title, axes, picture) {
    this.axes = axes;
    this.upright = axes[1] === 2;
    this.canvas = make("canvas");
    this.picture = make("img", { src: picture, alt: "" });
    this.picture.addEventListener("load", () => this.draw());
    this.box = make("div", { class: "map" }, this.canvas);
    this.element = make("figure", {}, make("figcaption", { text: title }), this.box);
    new ResizeObserver(() => this.draw()).observe(this.box);
  }

  /** Shows the world with these heads; `near`: around the sonars alone. */
  show(world, status, near) {
    Object.assign(this, { world, status, near });
    this.draw();
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!this.world || !width) {
      return;
    }
    const scale = devicePixelRatio || 1;
    Object.assign(this.canvas, { width: Math.round(width * scale), height: Math.round(height * scale) });
    this.context = this.canvas.getContext("2d");
    this.context.scale(scale, scale);
    this.context.font = "11px system-ui, sans-serif";
    this.context.lineJoin = "round";
    this.labels = [];
    this.fit(width, height);
    this.drawAxes(width, height);
    this.context.save();
    this.context.beginPath();
    this.context.rect(MARGIN.left, 0, width - MARGIN.left, height - MARGIN.bottom);
    this.context.clip();
    this.drawGround();
    this.drawGrid(width, height);
    this.drawBodies();
    this.drawHeads();
    this.drawVehicle();
    this.writeNames();
    this.context.restore();
  }

  flat(point) {
    return [point[this.axes[0]], point[this.axes[1]]];
  }

  pixel(point) {
    const [right, up] = this.flat(point);
    return [this.x + right * this.perMetre, this.y - up * this.perMetre];
  }

  heads() {
    return this.status.heads.filter((head) => head.pose && head.range_m > 0 && head.aperture);
  }

  /** Points that must be seen. */
  subjects() {
    const fans = this.heads().flatMap((head) => footprint(head, this.upright));
    if (this.near && fans.length) {
      return fans;
    }
    const { vehicle } = this.status.poses;
    const { min, max } = this.world.extent_m;
    return [min, max, ...fans, ...(vehicle ? [vehicle.position_m] : [])];
  }

  fit(width, height) {
    const points = this.subjects().map((point) => this.flat(point)).filter((point) => point.every(Number.isFinite));
    const limits = [0, 1].map((axis) => {
      const values = points.map((point) => point[axis]);
      const [low, high] = [Math.min(...values), Math.max(...values)];
      const more = Math.max(0.5, 0.04 * (high - low));
      return [low - more, high + more];
    });
    const room = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    this.perMetre = Math.min(room[0] / (limits[0][1] - limits[0][0]), room[1] / (limits[1][1] - limits[1][0]));
    const middle = limits.map(([low, high]) => (low + high) / 2);
    this.x = MARGIN.left + room[0] / 2 - middle[0] * this.perMetre;
    this.y = MARGIN.top + room[1] / 2 + middle[1] * this.perMetre;
  }

  drawGround() {
    if (this.picture.complete && this.picture.naturalWidth) {
      const { min, max } = this.world.extent_m;
      const [left, bottom] = this.pixel(min);
      const [right, top] = this.pixel(max);
      this.context.globalAlpha = GROUND_ALPHA;
      this.context.drawImage(this.picture, left, top, right - left, bottom - top);
      this.context.globalAlpha = 1;
    }
  }

  stroke(points, colour, fill) {
    const { context } = this;
    context.beginPath();
    points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
    if (fill) {
      context.closePath();
      context.fillStyle = fill;
      context.fill();
    }
    context.strokeStyle = colour;
    context.stroke();
  }

  /** Calls `each` with the coordinate and the pixel of every line of the grid, of one axis. */
  everyLine(axis, width, height, each) {
    const step = ringStep((5 * LEAST_STEP_PX) / this.perMetre);
    const from = axis === 0 ? (MARGIN.left - this.x) / this.perMetre : (this.y - height + MARGIN.bottom) / this.perMetre;
    const to = axis === 0 ? (width - this.x) / this.perMetre : this.y / this.perMetre;
    for (let line = Math.ceil(from / step); line * step <= to; ++line) {
      const value = line * step;
      each(number(value, step < 1 ? 1 : 0), axis === 0 ? this.x + value * this.perMetre : this.y - value * this.perMetre);
    }
  }

  drawAxes(width, height) {
    const { context } = this;
    context.fillStyle = COLOUR.axis;
    context.textBaseline = "middle";
    context.textAlign = "center";
    this.everyLine(0, width, height, (text, x) => x < width - 10 && context.fillText(text, x, height - 10));
    context.textAlign = "right";
    this.everyLine(1, width, height, (text, y) => y > 8 && context.fillText(text, MARGIN.left - 7, y));
  }

  drawGrid(width, height) {
    this.everyLine(0, width, height, (_, x) => this.stroke([[x, 0], [x, height]], COLOUR.grid));
    this.everyLine(1, width, height, (_, y) => this.stroke([[0, y], [width, y]], COLOUR.grid));
    if (this.upright && typeof this.world.water_surface_z_m === "number") {
      const y = this.y - this.world.water_surface_z_m * this.perMetre;
      this.stroke([[0, y], [width, y]], COLOUR.water);
      this.labels.push({ text: "water surface", at: [width - 46, y - 8], weight: 1e5 });
    }
  }

  drawBodies() {
    const moved = new Map((this.status.poses.bodies ?? []).map((body) => [body.name, body]));
    const { min, max } = this.world.extent_m;
    const [width] = this.flat(max.map((value, axis) => value - min[axis]));
    for (const body of this.world.bodies) {
      const pose = moved.get(body.name) ?? body;
      const hull = (this.upright ? body.side : body.top) ?? [];
      const points = hull.map(([a, b]) => this.pixel(place(pose, this.upright ? [a, 0, b] : [a, b, 0])));
      const extent = this.extentOf(points);
      const ground = extent > 0.8 * width * this.perMetre;
      if (points.length > 1 && !ground) {
        this.stroke([...points, points[0]], body.moves ? COLOUR.moving : COLOUR.still);
      }
      this.labels.push({ text: body.name, at: this.middleOf(points, pose), weight: body.moves ? 1e6 : ground ? -1 : extent, size: extent });
    }
  }

  extentOf(points) {
    const across = points.map(([x]) => x);
    return across.length ? Math.max(...across) - Math.min(...across) : 0;
  }

  middleOf(points, pose) {
    if (!points.length) {
      return this.pixel(pose.position_m);
    }
    const top = Math.min(...points.map(([, y]) => y));
    const across = points.map(([x]) => x);
    return [(Math.min(...across) + Math.max(...across)) / 2, top - 8];
  }

  drawHeads() {
    for (const head of this.heads()) {
      this.stroke(footprint(head, this.upright).map((point) => this.pixel(point)).concat([this.pixel(head.pose.position_m)]), COLOUR.edge, COLOUR.fan);
    }
  }

  drawVehicle() {
    const { vehicle } = this.status.poses;
    if (!vehicle) {
      return;
    }
    const [x, y] = this.pixel(vehicle.position_m);
    const [noseX, noseY] = this.pixel(place(vehicle, [1, 0, 0]));
    const turn = Math.atan2(noseY - y, noseX - x);
    const corner = (angle, length) => [x + length * Math.cos(turn + angle), y + length * Math.sin(turn + angle)];
    this.stroke([corner(0, 9), corner(2.5, 8), corner(Math.PI, 3), corner(-2.5, 8)], COLOUR.halo, COLOUR.vehicle);
    this.labels.push({ text: "vehicle", at: [x, y + 16], weight: Infinity });
  }

  /** Names: the vehicle, what moves, then the largest first. One that would lie on another goes below its body, or is left out. */
  writeNames() {
    const { context } = this;
    const taken = [];
    context.textAlign = "center";
    context.textBaseline = "middle";
    for (const { text, at, size } of this.labels.sort((a, b) => b.weight - a.weight)) {
      const half = context.measureText(text).width / 2 + 4;
      const free = [0, 16 + Math.min(40, size ?? 0)].map((up) => [this.held(at[0], half), this.heldUp(at[1] + up)]).find(([x, y]) =>
        taken.every((box) => Math.abs(box.x - x) >= box.half + half || Math.abs(box.y - y) >= 13));
      if (!free) {
        continue;
      }
      taken.push({ x: free[0], y: free[1], half });
      context.strokeStyle = COLOUR.halo;
      context.lineWidth = 3;
      context.strokeText(text, ...free);
      context.fillStyle = COLOUR.name;
      context.fillText(text, ...free);
      context.lineWidth = 1;
    }
  }

  held(x, half) {
    const width = this.box.clientWidth;
    return x < MARGIN.left - 20 || x > width + 20 ? x : Math.max(MARGIN.left + half, Math.min(width - half, x));
  }

  heldUp(y) {
    return y < -20 ? y : Math.max(9, y);
  }
}
