// SPDX-License-Identifier: Apache-2.0
// What lies over the echoes: range rings, bearing lines, the newest line of a scanning head, the cursor.
import { number } from "./text.js";

const LINE = "rgba(150, 185, 215, 0.24)";
const LABEL = "rgba(206, 217, 228, 0.88)";
const HALO = "rgba(8, 11, 16, 0.9)";
const MARK = "#e5a552";
const DEGREE = Math.PI / 180;

/** 1, 2 or 5 times a power of ten that gives at most five rings. */
export function ringStep(range_m) {
  const least = range_m / 5;
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.999);
}

function bearingsOf(mode, model) {
  const width = (model.last_rad - model.first_rad) / DEGREE;
  const step = [5, 10, 15, 30, 45].find((one) => width / one <= 8) ?? 45;
  const from = Math.ceil(model.first_rad / DEGREE / step - 0.01) * step;
  const all = [];
  for (let bearing = from; bearing <= model.last_rad / DEGREE + 0.01; bearing += step) {
    if (!(mode === "fan" && model.turns && bearing === -180)) {
      all.push(bearing);
    }
  }
  return all;
}

/** Draws in pixels of a canvas whose `scale` is the number of its pixels to one of the page. */
export class Grid {
  constructor(context, scale) {
    this.context = context;
    this.scale = scale;
    context.font = `${11 * scale}px system-ui, sans-serif`;
    context.lineWidth = scale;
    context.lineJoin = "round";
  }

  label(text, x, y, align = "center", baseline = "middle") {
    const { context, scale } = this;
    context.textAlign = align;
    context.textBaseline = baseline;
    context.strokeStyle = HALO;
    context.lineWidth = 3 * scale;
    context.strokeText(text, x, y);
    context.fillStyle = LABEL;
    context.fillText(text, x, y);
    context.lineWidth = scale;
  }

  line(from, to, style = LINE) {
    const { context } = this;
    context.strokeStyle = style;
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.stroke();
  }

  draw(mode, model, projection) {
    const range_m = projection.range_m;
    const step = ringStep(range_m);
    const decimals = step < 1 ? Math.ceil(-Math.log10(step) - 1e-9) : 0;
    for (let ring = step; ring <= range_m * 1.0001; ring += step) {
      const last = ring + step > range_m * 1.0001;
      const text = number(ring, decimals, last ? "m" : "");
      if (mode === "polar") {
        this.rangeLine(model, projection, ring, text);
      } else {
        this.ring(model, projection, ring, text);
      }
    }
    for (const bearing of bearingsOf(mode, model)) {
      this.bearing(mode, projection, bearing);
    }
    if (mode === "fan") {
      this.outline(model, projection);
    }
  }

  arc(model, projection, range_m) {
    const { context } = this;
    context.strokeStyle = LINE;
    context.beginPath();
    context.arc(projection.x, projection.y, range_m * projection.perMetre, model.first_rad - Math.PI / 2, model.last_rad - Math.PI / 2);
    context.stroke();
  }

  ring(model, projection, range_m, text) {
    this.arc(model, projection, range_m);
    if (model.turns) {
      const [x, y] = projection.pixel(range_m, 0);
      this.label(text, x + 5 * this.scale, y + 10 * this.scale, "left");
      return;
    }
    const [x, y] = projection.pixel(range_m, model.last_rad);
    const away = 9 * this.scale;
    this.label(text, x + away * Math.cos(model.last_rad), y + away * Math.sin(model.last_rad), "left");
  }

  outline(model, projection) {
    this.arc(model, projection, projection.range_m);
    if (!model.turns) {
      for (const edge of [model.first_rad, model.last_rad]) {
        this.line(projection.pixel(0, edge), projection.pixel(projection.range_m, edge));
      }
    }
  }

  rangeLine(model, projection, range_m, text) {
    const [x, y] = projection.pixel(range_m, model.first_rad);
    this.line([x, y], projection.pixel(range_m, model.last_rad));
    this.label(text, x - 7 * this.scale, y, "right");
  }

  bearing(mode, projection, bearing_deg) {
    const bearing = bearing_deg * DEGREE;
    const [x, y] = projection.pixel(projection.range_m, bearing);
    const base = projection.pixel(0, bearing);
    // Towards the apex of a fan the lines would hide what is near.
    this.line(mode === "polar" ? base : projection.pixel(0.12 * projection.range_m, bearing), [x, y]);
    const text = `${number(bearing_deg)}°`;
    if (mode === "polar") {
      this.label(text, x, base[1] + 13 * this.scale);
    } else {
      const away = 13 * this.scale;
      this.label(text, x + 1.5 * away * Math.sin(bearing), y - away * Math.cos(bearing));
    }
  }

  newest(projection, bearing_rad) {
    this.context.lineWidth = 1.5 * this.scale;
    this.line(projection.pixel(0, bearing_rad), projection.pixel(projection.range_m, bearing_rad), MARK);
    this.context.lineWidth = this.scale;
  }

  cursor(x, y) {
    const { scale } = this;
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      this.line([x + 4 * scale * dx, y + 4 * scale * dy], [x + 12 * scale * dx, y + 12 * scale * dy], "rgba(240, 245, 250, 0.9)");
    }
  }
}
