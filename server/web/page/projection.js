// SPDX-License-Identifier: Apache-2.0
// Where a range and a bearing lie in a picture. Pixels are those of the canvas; ahead is up, port is on the left.

const MARGIN = { fan: { left: 42, right: 42, top: 26, bottom: 14 }, polar: { left: 46, right: 20, top: 12, bottom: 26 } };

/** Least and greatest value of a function of the bearing over a sector, and at its apex, where it is 0. */
function bounds(model, value) {
  const places = [model.first_rad, model.last_rad];
  for (let quarter = -2; quarter <= 2; ++quarter) {
    const bearing = (quarter * Math.PI) / 2;
    if (bearing > model.first_rad && bearing < model.last_rad) {
      places.push(bearing);
    }
  }
  const values = places.map(value).concat(0);
  return [Math.min(...values), Math.max(...values)];
}

/** Height at which a fan as wide as this fills its box, in the same pixels. */
export function heightOfFan(model, width) {
  const margin = marginOfFan(model);
  const [left, right] = bounds(model, Math.sin);
  const [bottom, top] = bounds(model, Math.cos);
  return ((width - margin.left - margin.right) / (right - left)) * (top - bottom) + margin.top + margin.bottom;
}

function marginOfFan(model) {
  return { ...MARGIN.fan, ...(model.turns && { bottom: MARGIN.fan.top }) };
}

/** The scene from above. */
class FanProjection {
  constructor(model, width, height, scale) {
    const margin = marginOfFan(model);
    this.range_m = model.rows * model.bin_m;
    const [left, right] = bounds(model, Math.sin);
    const [bottom, top] = bounds(model, Math.cos);
    const room = { x: width - scale * (margin.left + margin.right), y: height - scale * (margin.top + margin.bottom) };
    this.radius_px = Math.max(10, Math.min(room.x / (right - left), room.y / (top - bottom)));
    this.perMetre = this.radius_px / this.range_m;
    this.x = width / 2 - (this.radius_px * (right + left)) / 2;
    this.y = scale * margin.top + (room.y - this.radius_px * (top - bottom)) / 2 + this.radius_px * top;
  }

  polar(x, y) {
    const ahead = this.y - y;
    const starboard = x - this.x;
    return { range_m: Math.hypot(ahead, starboard) / this.perMetre, bearing_rad: Math.atan2(starboard, ahead) };
  }

  pixel(range_m, bearing_rad) {
    const length = range_m * this.perMetre;
    return [this.x + length * Math.sin(bearing_rad), this.y - length * Math.cos(bearing_rad)];
  }
}

/** Bearing to the right, range upwards: samples as they come, known to the trade as B-scan. */
class PolarProjection {
  constructor(model, width, height, scale) {
    const margin = MARGIN.polar;
    this.range_m = model.rows * model.bin_m;
    this.first_rad = model.first_rad;
    this.left = scale * margin.left;
    this.bottom = height - scale * margin.bottom;
    this.width = Math.max(10, width - scale * (margin.left + margin.right));
    this.radius_px = Math.max(10, height - scale * (margin.top + margin.bottom));
    this.perMetre = this.radius_px / this.range_m;
    this.perRadian = this.width / (model.last_rad - model.first_rad);
  }

  polar(x, y) {
    return { range_m: (this.bottom - y) / this.perMetre, bearing_rad: this.first_rad + (x - this.left) / this.perRadian };
  }

  pixel(range_m, bearing_rad) {
    return [this.left + (bearing_rad - this.first_rad) * this.perRadian, this.bottom - range_m * this.perMetre];
  }
}

export function makeProjection(mode, model, width, height, scale) {
  const Kind = mode === "polar" ? PolarProjection : FanProjection;
  return new Kind(model, width, height, scale);
}

/**
 * Which samples each pixel of a picture shows, worked out once for a shape: of the row it lies in, the two columns
 * beside its bearing with their weights.
 */
export class Lookup {
  constructor(model, projection, width, height) {
    this.pixels = new Uint32Array(width * height);
    this.left = new Uint32Array(width * height);
    this.right = new Uint32Array(width * height);
    this.weight = new Uint16Array(width * height);
    this.size = 0;
    for (let y = 0, pixel = 0; y < height; ++y) {
      for (let x = 0; x < width; ++x, ++pixel) {
        this.add(model, pixel, projection.polar(x + 0.5, y + 0.5));
      }
    }
  }

  add(model, pixel, { range_m, bearing_rad }) {
    const row = Math.floor(range_m / model.bin_m);
    if (row < 0 || row >= model.rows) {
      return;
    }
    const column = model.column(bearing_rad);
    if (Number.isNaN(column) || bearing_rad < model.first_rad || bearing_rad > model.last_rad) {
      return;
    }
    const lower = Math.floor(column);
    this.pixels[this.size] = pixel;
    this.left[this.size] = row * model.columns + this.inside(model, lower);
    this.right[this.size] = row * model.columns + this.inside(model, lower + 1);
    this.weight[this.size] = Math.round(256 * (column - lower));
    ++this.size;
  }

  inside(model, column) {
    if (model.turns) {
      return (column + model.columns) % model.columns;
    }
    return Math.min(model.columns - 1, Math.max(0, column));
  }

  /** Colours the pixels, 32 bits each, of samples. Pixels that show none are left alone. */
  paint(target, samples, table) {
    const { pixels, left, right, weight, size } = this;
    for (let i = 0; i < size; ++i) {
      const from = samples[left[i]];
      target[pixels[i]] = table[from + (((samples[right[i]] - from) * weight[i]) >> 8)];
    }
  }
}
